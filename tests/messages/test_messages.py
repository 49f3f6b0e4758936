# SPDX-License-Identifier: Apache-2.0
"""Definitions of messages: the grammar of ``.msg`` files, hashes of types, complete definitions."""

from __future__ import annotations

import json
import os
from pathlib import Path

import pytest

from epg.generator.diagnostics import Diagnostics
from epg.generator.messages.definition import FieldType, Message, parse_message
from epg.generator.messages.library import Library, complete_definition
from epg.generator.messages.type_hash import type_hash
from epg.generator.source import Span
from tests.doubles.ros2_peer import definitions


def loaded(*names: str, folders: tuple[Path, ...] = ()) -> Library:
    library, diagnostics = Library(folders), Diagnostics()
    for name in names:
        assert library.load(name, Span(name), diagnostics), [item.message for item in diagnostics]
    return library


def parse(text: str) -> Message:
    diagnostics = Diagnostics()
    message = parse_message("robot_msgs/msg/Own", text, Path("Own.msg"), diagnostics)
    assert message is not None, [item.message for item in diagnostics]
    return message


def mistakes(text: str) -> list[tuple[int, int, int, str]]:
    diagnostics = Diagnostics()
    assert parse_message("robot_msgs/msg/Own", text, Path("Own.msg"), diagnostics) is None
    return [(item.span.line, item.span.column, item.span.end, item.message) for item in diagnostics]


def test_fields_of_every_form() -> None:
    message = parse(
        "# A comment\n"
        "\n"
        "float64 plain   # with a comment\n"
        "uint8 KIND=3\n"
        'string TEXT = "a # b"\n'
        'string<=20 label "a # b"\n'
        "  int16[3] fixed [1, 2, 3]\n"
        "float32[<=4] bounded\n"
        "string<=5[] names\n"
        "Pose here\n"
        "geometry_msgs/Vector3 there\n"
        "geometry_msgs/msg/Vector3[2] full\n"
    )
    assert [(field.name, field.type, field.default) for field in message.fields] == [
        ("plain", FieldType("float64"), ""),
        ("label", FieldType("string", 20), '"a # b"'),
        ("fixed", FieldType("int16", 0, "array", 3), "[1, 2, 3]"),
        ("bounded", FieldType("float32", 0, "bounded", 4), ""),
        ("names", FieldType("string", 5, "sequence"), ""),
        ("here", FieldType("robot_msgs/msg/Pose"), ""),
        ("there", FieldType("geometry_msgs/msg/Vector3"), ""),
        ("full", FieldType("geometry_msgs/msg/Vector3", 0, "array", 2), ""),
    ]
    assert message.dependencies == ("geometry_msgs/msg/Vector3", "robot_msgs/msg/Pose")
    assert message.fields[2].span == Span("Own.msg", 7, 12, 17)


def test_mistakes_have_positions() -> None:
    assert mistakes("float64 good\nfloat65 bad\n") == [(2, 1, 8, "'float65' is not a type of ROS 2")]
    assert mistakes("float64\n") == [(1, 1, 8, "the name of the field is missing")]
    assert mistakes("float64 Bad") == [(1, 9, 12, "'Bad' cannot be the name of a field")]
    assert mistakes("float64 a__b") == [(1, 9, 13, "'a__b' cannot be the name of a field")]
    assert mistakes("uint8 bad=3") == [(1, 7, 10, "'bad' cannot be the name of a constant")]
    assert mistakes("bool BAD=2") == [(1, 9, 11, "'2' is not a value of a bool: true or false")]
    assert parse("bool GOOD=true\nbool FINE = 0").constants == {"GOOD": "true", "FINE": "0"}
    assert mistakes("uint8 a\nuint8 a") == [(2, 7, 8, "the message already has a field 'a'")]
    assert mistakes("float64<=3 a") == [(1, 1, 11, "only strings can have a bound: string<=20")]
    assert mistakes("float64[0] a") == [(1, 1, 11, "a length must be from 1 to 1048576")]
    assert mistakes("float64[99999999999999] a") == [(1, 1, 24, "a length must be from 1 to 1048576")]
    assert mistakes("float64[ a") == [(1, 1, 9, "'float64[' is not a type of ROS 2")]


def test_a_message_that_contains_itself(tmp_path: Path) -> None:
    folder = tmp_path / "robot_msgs/msg"
    folder.mkdir(parents=True)
    (folder / "A.msg").write_text("B b\n", encoding="utf-8")
    (folder / "B.msg").write_text("float64 x\nA a\n", encoding="utf-8")
    diagnostics = Diagnostics()
    assert Library([tmp_path]).load("robot_msgs/msg/A", Span("x"), diagnostics) is None
    (item,) = diagnostics
    assert (Path(item.span.file).name, item.span.line) == ("B.msg", 2)
    assert item.message == "the message robot_msgs/msg/A contains itself"


def test_an_unknown_message_names_a_similar_one() -> None:
    diagnostics = Diagnostics()
    assert Library().load("sensor_msgs/msg/Imo", Span("robot.tcf", 3), diagnostics) is None
    (item,) = diagnostics
    assert item.message == "EPG does not know the message sensor_msgs/msg/Imo"
    assert item.hint == "did you mean 'sensor_msgs/msg/Imu'?"


def test_a_complete_definition_has_each_message_once() -> None:
    """The form is that of rosbag2's docs/message_definition_encoding.md."""
    library = loaded("nav_msgs/msg/Odometry")
    text = complete_definition(library, "nav_msgs/msg/Odometry")
    names = [line for line in text.splitlines() if line.startswith("MSG: ")]
    assert sorted(names) == names[:0] + sorted(set(names)) and "MSG: geometry_msgs/Quaternion" in names
    assert text.count("=" * 80) == len(names) == 9
    assert text.split("=" * 80)[0].split("\n", 1)[1].splitlines() == [
        "std_msgs/Header header",
        "string child_frame_id",
        "geometry_msgs/PoseWithCovariance pose",
        "geometry_msgs/TwistWithCovariance twist",
        "",
    ]


def test_hashes_are_those_of_the_runtime_and_of_ros2() -> None:
    both = sorted(set(definitions.DEFINITIONS) & set(Library().names()))
    assert len(both) > 10
    for name in both:
        assert type_hash(loaded(name), name) == definitions.type_hash(name)
    # as `ros2 topic info --verbose` of Jazzy shows it
    imu = "RIHS01_7d9a00ff131080897a5ec7e26e315954b8eae3353c3f995c55faf71574000b5b"
    assert type_hash(loaded("sensor_msgs/msg/Imu"), "sensor_msgs/msg/Imu") == imu


@pytest.mark.parametrize(
    ("name", "text", "hash"),
    [
        ("std_msgs/msg/Int8", "int8 data", "26525065a403d972cb672f0777e333f0c799ad444ae5fcd79e43d1e73bd0f440"),
        (
            "px4_msgs/msg/CollisionConstraints",
            "uint64 timestamp\nfloat32[2] original_setpoint\nfloat32[2] adapted_setpoint",
            "9f577d2403521a50ad0dc4bdaeb0e9070bd4400b652c3c327b93e384a0ce08b8",
        ),
    ],
    ids=["int8", "uint64 and arrays"],
)
def test_hashes_that_rosidl_has_written(name: str, text: str, hash: str, tmp_path: Path) -> None:
    file = tmp_path / f"{name}.msg"
    file.parent.mkdir(parents=True)
    file.write_text(f"{text}\n", encoding="ascii")
    assert type_hash(loaded(name, folders=(tmp_path,)), name) == f"RIHS01_{hash}"


def test_hashes_of_all_messages_where_ros2_is_sourced() -> None:
    """rosidl has written the hash of each message into a JSON file beside its definition."""
    prefixes = [Path(prefix) / "share" for prefix in os.environ.get("AMENT_PREFIX_PATH", "").split(":") if prefix]
    files = [file for prefix in prefixes for file in sorted(prefix.glob("*/msg/*.json"))]
    files = [file for file in files if file.with_suffix(".msg").is_file()]
    if not files:
        pytest.skip("ROS 2 is not sourced: install ROS 2 Jazzy and '. /opt/ros/jazzy/setup.bash'")
    own = Library()
    for file in files:
        name = f"{file.parent.parent.name}/msg/{file.stem}"
        hashes = json.loads(file.read_text(encoding="utf-8"))["type_hashes"]
        expected = next(entry["hash_string"] for entry in hashes if entry["type_name"] == name)
        assert type_hash(loaded(name, folders=tuple(prefixes)), name) == expected
        if name in own.names():
            assert type_hash(loaded(name), name) == expected, "EPG's definition is that of ROS 2"
