# SPDX-License-Identifier: Apache-2.0
"""Messages of any type: the runtime's bytes are those of another implementation of CDR, rosbags."""

from __future__ import annotations

import ctypes
import math
import random
import shutil
import struct
import subprocess
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import pytest

from epg.generator.diagnostics import Diagnostics
from epg.generator.messages.byte_layout import MessageType, message_type
from epg.generator.messages.constants import Constant
from epg.generator.messages.library import Library, complete_definition
from epg.generator.source import Span

rosbags = pytest.importorskip(
    "rosbags.typesys", reason="rosbags is not installed: pip install -r epg/generator/lock/test_all.txt"
)

RUNTIME = Path(__file__).resolve().parents[2] / "targets/runtime"
HERE = Span("robot.tcf", 3, 4, 5)

EVERY = """\
std_msgs/Header header
uint8 OPEN=0
uint8 CLOSED=1
bool holding
byte raw_byte
char letter
int8 i8
uint8 state 1
int16 i16
uint16 u16
int32 i32
uint32 u32
int64 i64
uint64 u64
float32 f32
float64 f64 1.5
float32[3] force
string<=10 label "left"
geometry_msgs/Vector3[2] corners
float64[<=4] some
int16[] any
string[2] two
string<=5[<=3] names
geometry_msgs/Point[] path
uint8 last
"""
KINDS = {
    "BOOL": 0,
    "INT8": 1,
    "UINT8": 2,
    "INT16": 3,
    "UINT16": 4,
    "INT32": 5,
    "UINT32": 6,
    "INT64": 7,
    "UINT64": 8,
    "FLOAT32": 9,
    "FLOAT64": 10,
    "STRING": 11,
    "STAMP": 12,
}
SKIP = 0xFFFF


class Stamp(ctypes.Structure):
    _fields_ = [("seconds", ctypes.c_int32), ("nanoseconds", ctypes.c_uint32)]


class Place(ctypes.Structure):
    _fields_ = [("offset", ctypes.c_uint16), ("type", ctypes.c_uint8)]


class Step(ctypes.Structure):
    _fields_ = [
        ("type", ctypes.c_uint8),
        ("sequence", ctypes.c_bool),
        ("count", ctypes.c_uint16),
        ("value", ctypes.c_uint16),
    ]


class Table(ctypes.Structure):
    _fields_ = [
        ("message", ctypes.c_void_p * 5),
        ("data", ctypes.c_void_p),
        ("size", ctypes.c_size_t),
        ("places", ctypes.POINTER(Place)),
        ("place_count", ctypes.c_size_t),
        ("steps", ctypes.POINTER(Step)),
        ("step_count", ctypes.c_size_t),
    ]


class Topic(ctypes.Structure):
    _fields_ = [("name", ctypes.c_char_p), ("message", ctypes.c_void_p), ("rest", ctypes.c_void_p * 16)]


@pytest.fixture(scope="module")
def runtime(tmp_path_factory: pytest.TempPathFactory) -> ctypes.CDLL:
    """The runtime's functions, compiled for this computer."""
    compiler = shutil.which("cc")
    if compiler is None:
        pytest.skip("gcc is not installed: sudo apt install gcc")
    library = tmp_path_factory.mktemp("runtime") / "messages.so"
    sources = [str(RUNTIME / "src" / "communication" / name) for name in ("message_table.c", "cdr.c")]
    flags = ["-std=c11", "-O1", "-Wall", "-Wextra", "-Wconversion", "-Wdouble-promotion", "-Werror", "-fPIC", "-shared"]
    flags += ["-fsanitize=undefined", "-fno-sanitize-recover", "-static-libubsan"]
    subprocess.run([compiler, *flags, f"-I{RUNTIME / 'include'}", *sources, "-lm", "-o", str(library)], check=True)
    loaded = ctypes.CDLL(str(library))
    loaded.epg_message_table_write.restype = ctypes.c_size_t
    loaded.epg_message_table_write.argtypes = [
        ctypes.c_void_p,
        ctypes.c_void_p,
        Stamp,
        ctypes.c_void_p,
        ctypes.c_size_t,
    ]
    loaded.epg_message_table_read.restype = ctypes.c_bool
    loaded.epg_message_table_read.argtypes = [ctypes.c_void_p, ctypes.c_char_p, ctypes.c_size_t, ctypes.c_void_p]
    return loaded


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    path = tmp_path / "robot_msgs/msg/Every.msg"
    path.parent.mkdir(parents=True)
    path.write_text(EVERY, encoding="utf-8")
    return tmp_path


def constant(value: Any) -> Constant:
    if isinstance(value, list):
        return Constant(tuple(constant(one) for one in value), HERE, HERE)
    return Constant(value, HERE, HERE)


def made(
    name: str,
    constants: Mapping[str, Any],
    folder: Path,
    received: bool = False,
    lengths: Mapping[str, Any] | None = None,
) -> tuple[MessageType | None, Library, Diagnostics]:
    library, diagnostics = Library([folder]), Diagnostics()
    assert library.load(name, HERE, diagnostics), [item.message for item in diagnostics]
    given = {key: constant(value) for key, value in constants.items()}
    counts = {key: constant(value) for key, value in (lengths or {}).items()}
    return message_type(library, name, given, counts, received, HERE, diagnostics), library, diagnostics


def typestore(library: Library, name: str) -> Any:
    store = rosbags.get_typestore(rosbags.Stores.EMPTY)
    store.register(rosbags.get_types_from_msg(complete_definition(library, name), name))
    return store


def write(runtime: ctypes.CDLL, message: MessageType, values: Mapping[str, float], stamp: tuple[int, int]) -> bytes:
    """The bytes of a message with some values, as the generated tables give them."""
    places = [message.places[name] for name in values] + list(message.stamps)
    data = (ctypes.c_uint8 * len(message.data))(*message.data)
    table = Table(
        data=ctypes.cast(data, ctypes.c_void_p),
        size=len(message.data),
        places=(Place * len(places))(*[Place(place.offset, KINDS[place.type]) for place in places]),
        place_count=len(places),
    )
    topic = Topic(b"t", ctypes.cast(ctypes.pointer(table), ctypes.c_void_p))
    numbers = (ctypes.c_double * max(1, len(values)))(*values.values())
    room = (ctypes.c_uint8 * 8192)(*([0xAA] * 8192))
    assert (
        runtime.epg_message_table_write(ctypes.byref(topic), numbers, Stamp(*stamp), room, len(message.data) - 1) == 0
    )
    size = runtime.epg_message_table_write(ctypes.byref(topic), numbers, Stamp(*stamp), room, 8192)
    assert size == len(message.data) and set(room[size:]) == {0xAA}
    return bytes(room[:size])


def read(runtime: ctypes.CDLL, message: MessageType, names: list[str], data: bytes) -> list[float] | None:
    steps = [
        Step(KINDS[s.type], s.sequence, s.count, names.index(s.name) if s.name in names else SKIP)
        for s in message.steps
    ]
    table = Table(steps=(Step * len(steps))(*steps), step_count=len(steps))
    topic = Topic(b"t", ctypes.cast(ctypes.pointer(table), ctypes.c_void_p))
    values = (ctypes.c_double * len(names))()
    exact = ctypes.create_string_buffer(data, len(data)) if data else ctypes.create_string_buffer(1)
    good = runtime.epg_message_table_read(ctypes.byref(topic), exact, len(data), values)
    return list(values) if good else None


def field(message: Any, path: str) -> Any:
    for part in path.split("."):
        message = message[int(part)] if part.isdigit() else getattr(message, part)
    return message


SENT = {
    "sensor_msgs/msg/Imu": (
        {"header.frame_id": "imu_link", "orientation_covariance.0": -1, "angular_velocity_covariance": [0.5] * 9},
        {"orientation.x": 0.25, "angular_velocity.z": -3.5, "linear_acceleration.x": 9.81},
        {
            "header.frame_id": "imu_link",
            "orientation.w": 1.0,
            "orientation_covariance.0": -1.0,
            "angular_velocity_covariance.8": 0.5,
            "orientation.x": 0.25,
            "angular_velocity.z": -3.5,
            "linear_acceleration.x": 9.81,
        },
    ),
    "sensor_msgs/msg/BatteryState": (
        {
            "power_supply_status": "POWER_SUPPLY_STATUS_DISCHARGING",
            "present": True,
            "cell_voltage": [3.5, 4.0],
            "location": "slot 1",
            "serial_number": "éß",
            "percentage": math.nan,
        },
        {"voltage": 7.5, "current": -2.0},
        {
            "power_supply_status": 2,
            "present": True,
            "cell_voltage.1": 4.0,
            "location": "slot 1",
            "serial_number": "éß",
            "voltage": 7.5,
            "current": -2.0,
        },
    ),
    "sensor_msgs/msg/Range": (
        {"radiation_type": "INFRARED", "field_of_view": 0.5, "max_range": 4},
        {"range": 1.25},
        {"radiation_type": 1, "field_of_view": 0.5, "max_range": 4.0, "range": 1.25},
    ),
    "nav_msgs/msg/Odometry": (
        {"header.frame_id": "odom", "child_frame_id": "base_link", "pose.covariance.35": 2.0},
        {"pose.pose.position.x": 1.5, "twist.twist.angular.z": 0.75},
        {
            "header.frame_id": "odom",
            "child_frame_id": "base_link",
            "pose.covariance.35": 2.0,
            "pose.pose.orientation.w": 1.0,
            "pose.pose.position.x": 1.5,
            "twist.twist.angular.z": 0.75,
        },
    ),
    "robot_msgs/msg/Every": (
        {"two": ["a", "bc"], "names": ["x", "yz"], "some": [1.0, 2.0], "any": [-3], "state": "CLOSED", "i64": -(2**63)},
        {
            "holding": 0.6,
            "i8": -200.0,
            "u8ish": 0.0,
            "i16": -1.5,
            "u16": 1e9,
            "u64": 2.0**63,
            "f32": 0.1,
            "last": 2.5,
            "corners.1.z": 7.0,
            "force.2": 0.5,
            "i32": math.nan,
            "u32": -4.0,
        },
        {
            "holding": True,
            "i8": -128,
            "i16": -2,
            "u16": 65535,
            "u64": 2**63,
            "f64": 1.5,
            "last": 3,
            "corners.1.z": 7.0,
            "force.2": 0.5,
            "i32": 0,
            "u32": 0,
            "two.1": "bc",
            "names.1": "yz",
            "some.1": 2.0,
            "any.0": -3,
            "label": "left",
            "state": 1,
            "i64": -(2**63),
        },
    ),
}


@pytest.mark.parametrize("name", SENT)
def test_another_program_reads_what_the_runtime_writes(name: str, runtime: ctypes.CDLL, folder: Path) -> None:
    constants, values, expected = SENT[name]
    values = {key: value for key, value in values.items() if key != "u8ish"}
    message, library, diagnostics = made(name, constants, folder)
    assert message is not None, [item.message for item in diagnostics]
    data = write(runtime, message, values, (17, 500))
    found = typestore(library, name).deserialize_cdr(b"\x00\x01\x00\x00" + data, name)
    assert (found.header.stamp.sec, found.header.stamp.nanosec) == (17, 500)
    for path, value in expected.items():
        assert field(found, path) == value, path
    if name == "sensor_msgs/msg/BatteryState":
        assert math.isnan(found.percentage)


@pytest.mark.parametrize("name", [name for name in SENT if name != "robot_msgs/msg/Every"])
def test_the_runtime_reads_what_another_program_writes(name: str, runtime: ctypes.CDLL, folder: Path) -> None:
    """The constants of a sent message are texts and sequences of any length in a received one."""
    constants, _, _ = SENT[name]
    sent, library, _ = made(name, constants, folder)
    received, _, diagnostics = made(name, {}, folder, received=True)
    assert sent is not None and received is not None, [item.message for item in diagnostics]
    values = {path: float(number % 100) / 4 if "power" not in path else 3.0 for number, path in enumerate(sent.names)}
    values = {path: 1.0 if path == "present" else float(int(value)) for path, value in values.items()}
    store = typestore(library, name)
    message = store.deserialize_cdr(b"\x00\x01\x00\x00" + write(runtime, sent, values, (1, 2)), name)
    data = bytes(store.serialize_cdr(message, name))[4:]
    names = list(sent.names)
    assert read(runtime, received, names, data) == list(values.values())
    assert len(data) <= received.largest
    chosen = random.Random(1).sample(names, 3)
    assert read(runtime, received, chosen, data) == [values[path] for path in chosen]
    for size in range(len(data) - 8):
        found = read(runtime, received, names, data[:size])
        assert found is None or name == "sensor_msgs/msg/BatteryState", "a message that ends too early is malformed"


def test_sequences_with_a_length_have_ports(runtime: ctypes.CDLL, folder: Path) -> None:
    """A transform for tf2 is an element of a sequence; so are the voltages of cells."""
    constants = {"transforms.0.header.frame_id": "odom", "transforms.0.child_frame_id": "base_link"}
    name = "tf2_msgs/msg/TFMessage"
    message, library, _ = made(name, constants, folder, lengths={"transforms": 1})
    assert message is not None
    place = "transforms.0.transform.translation.x"
    data = write(runtime, message, {place: 1.5, "transforms.0.transform.rotation.z": 0.5}, (3, 4))
    (found,) = typestore(library, name).deserialize_cdr(b"\x00\x01\x00\x00" + data, name).transforms
    assert (found.header.frame_id, found.child_frame_id, found.header.stamp.sec) == ("odom", "base_link", 3)
    assert (found.transform.translation.x, found.transform.rotation.z, found.transform.rotation.w) == (1.5, 0.5, 1.0)

    name = "sensor_msgs/msg/BatteryState"
    message, library, _ = made(name, {"cell_voltage": [1, 2, 3]}, folder, lengths={"cell_voltage": 3})
    assert message is not None
    data = write(runtime, message, {"cell_voltage.1": 3.5}, (0, 0))
    state = typestore(library, name).deserialize_cdr(b"\x00\x01\x00\x00" + data, name)
    assert list(state.cell_voltage) == [1.0, 3.5, 3.0] and len(state.cell_temperature) == 0

    constants = {"names": ["a", "b"]}
    name = "robot_msgs/msg/Every"
    message, library, _ = made(name, constants, folder, lengths={"names": 2, "path": 2, "some": 4, "any": 0})
    assert message is not None
    data = write(runtime, message, {"path.1.z": 7.0, "some.3": 0.5}, (0, 0))
    every = typestore(library, name).deserialize_cdr(b"\x00\x01\x00\x00" + data, name)
    assert every.names == ["a", "b"] and every.path[1].z == 7.0 and list(every.some) == [0, 0, 0, 0.5]


@pytest.mark.parametrize(
    ("lengths", "message"),
    [
        ({"sum": 1}, "the message has no sequence 'sum'"),
        ({"force": 3}, "the message has no sequence 'force'"),
        ({"some": 5}, "'some' must have at most 4 elements"),
        ({"any": 0.5}, "the length of 'any' must be a whole number from 0 to 256"),
        ({"any": 257}, "the length of 'any' must be a whole number from 0 to 256"),
    ],
)
def test_wrong_lengths_are_told(lengths: dict[str, Any], message: str, folder: Path) -> None:
    found, _, diagnostics = made("robot_msgs/msg/Every", {}, folder, lengths=lengths)
    assert found is None and [item.message for item in diagnostics] == [message]


def test_a_message_without_fields_has_one_byte(runtime: ctypes.CDLL, tmp_path: Path) -> None:
    path = tmp_path / "robot_msgs/msg"
    path.mkdir(parents=True)
    (path / "Nothing.msg").write_text("# no fields\n", encoding="utf-8")
    (path / "Around.msg").write_text("uint8 before\nNothing nothing\nuint8 behind\n", encoding="utf-8")
    message, library, _ = made("robot_msgs/msg/Around", {}, tmp_path)
    assert message is not None and message.names == ("before", "behind")
    data = write(runtime, message, {"before": 1.0, "behind": 2.0}, (0, 0))
    assert data == b"\x01\x00\x02"
    store = typestore(library, "robot_msgs/msg/Around")
    assert store.deserialize_cdr(b"\x00\x01\x00\x00" + data, "robot_msgs/msg/Around").behind == 2


def test_definitions_that_grow_without_end(tmp_path: Path) -> None:
    """Each message has 200 of the next one: 200 to the power of 12 numbers."""
    path = tmp_path / "robot_msgs/msg"
    path.mkdir(parents=True)
    for number in range(12):
        (path / f"M{number}.msg").write_text(f"M{number + 1}[200] more\n", encoding="utf-8")
    (path / "M12.msg").write_text("float64 x\n", encoding="utf-8")
    assert problems("robot_msgs/msg/M0", {}, tmp_path) == [
        ("robot.tcf", "robot_msgs/msg/M0 has more than 4096 fields, with those of the messages in it")
    ]
    for number in range(12, 20):
        (path / f"M{number}.msg").write_text(f"M{number + 1} more\n", encoding="utf-8")
    diagnostics = Diagnostics()
    assert Library([tmp_path]).load("robot_msgs/msg/M0", HERE, diagnostics) is None
    assert [item.message for item in diagnostics] == [
        "the message robot_msgs/msg/M0 contains more than 16 messages inside each other"
    ]


def test_signed_numbers_and_wrong_truth_values(runtime: ctypes.CDLL, tmp_path: Path) -> None:
    path = tmp_path / "robot_msgs/msg/Small.msg"
    path.parent.mkdir(parents=True)
    path.write_text(
        "bool on\nint8 a\nint16 b\nint32 c\nint64 d\nuint64 e\nstring[] texts\nuint8 last\n", encoding="utf-8"
    )
    message, _, _ = made("robot_msgs/msg/Small", {}, tmp_path, received=True)
    assert message is not None
    numbers = struct.pack("<?bhiqQ", True, -1, -2, -3, -4, 2**64 - 1)
    texts = struct.pack("<II2sxxI1s", 2, 2, b"a\0", 1, b"\0")
    names = ["on", "a", "b", "c", "d", "e", "last"]
    assert read(runtime, message, names, numbers + texts + b"\x05") == [1, -1, -2, -3, -4, 2.0**64, 5]
    assert read(runtime, message, names, b"\x02" + numbers[1:] + texts + b"\x05") is None
    assert read(runtime, message, names, numbers + struct.pack("<I", 2**32 - 1)) is None


def problems(name: str, constants: Mapping[str, Any], folder: Path, received: bool = False) -> list[tuple[str, str]]:
    message, _, diagnostics = made(name, constants, folder, received)
    assert message is None
    return [(Path(item.span.file).name, item.message) for item in diagnostics]


def test_what_is_not_supported_is_told(folder: Path) -> None:
    (folder / "robot_msgs/msg/Wide.msg").write_text("float64 x\nwstring text\n", encoding="utf-8")
    assert problems("robot_msgs/msg/Wide", {}, folder) == [("Wide.msg", "EPG does not support wstring")]
    (folder / "robot_msgs/msg/Big.msg").write_text("float64 x\nfloat64[200] a\nfloat64[100] b\n", encoding="utf-8")
    assert problems("robot_msgs/msg/Big", {}, folder) == [
        ("robot.tcf", "robot_msgs/msg/Big has 301 numbers, and EPG supports at most 256")
    ]
    (folder / "robot_msgs/msg/Text.msg").write_text("string text\nfloat64[2000] a\n", encoding="utf-8")
    assert problems("robot_msgs/msg/Text", {}, folder) == [
        ("robot.tcf", "robot_msgs/msg/Text does not have a field with a single number")
    ]
    assert problems("robot_msgs/msg/Every", {}, folder, received=True) == [
        ("Every.msg", "EPG cannot receive a sequence of messages, 'path'")
    ]


@pytest.mark.parametrize(
    ("constants", "message"),
    [
        ({"labl": "x"}, "the message has no field 'labl'"),
        ({"header.stamp": 3}, "'header.stamp' cannot be a constant: it is the time of the control cycle"),
        ({"label": "01234567890"}, "'label' must be text of at most 10 bytes, without NUL"),
        ({"label": 3}, "'label' must be text"),
        ({"i8": 128}, "128 is not an int8: -128 ... 127"),
        ({"u16": -1}, "-1 is not a uint16: 0 ... 65535"),
        ({"i32": 0.5}, "0.5 is not an int32: -2147483648 ... 2147483647"),
        ({"f32": 1e39}, "1e+39 does not fit into a float32"),
        ({"state": "LOCKED"}, "'LOCKED' is not a number"),
        ({"force": [1.0]}, "'force' must be a list of 3 values"),
        ({"some": [1, 2, 3, 4, 5]}, "'some' must have at most 4 elements"),
        ({"two": ["a"]}, "'two' must have 2 elements"),
        ({"any": 3}, "'any' must be a list"),
        ({"names": ["abcdef"]}, "'names' must be text of at most 5 bytes, without NUL"),
    ],
)
def test_wrong_constants_are_told(constants: dict[str, Any], message: str, folder: Path) -> None:
    assert problems("robot_msgs/msg/Every", constants, folder) == [("robot.tcf", message)]
