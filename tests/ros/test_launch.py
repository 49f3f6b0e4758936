# SPDX-License-Identifier: Apache-2.0
"""``epg launch``: its files mean the same to Python, bash and systemd as the user's request."""

from __future__ import annotations

import ast
import importlib.util
import json
import re
import shlex
import shutil
import subprocess
from pathlib import Path
from typing import Any

import pytest

from epg.cli.main import main
from epg.generator.catalog.catalog import load_catalog
from epg.generator.data import data_folder, targets_roots
from epg.generator.diagnostics import Diagnostics
from epg.ros.systemd_units import device_unit
from tests.doubles.toolchain import ROOT

from .description import write_description

FIRST, SECOND = "E6614103E72B8C2F", "E6614103E72B8C30"
BY_ID = "/dev/serial/by-id/usb-Raspberry_Pi_Pico_{}-if00"


@pytest.fixture
def robots(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Two images on USB, one on a serial line, two targets with UDP, in the current folder."""
    monkeypatch.chdir(tmp_path)
    write_description(tmp_path / "jiwy.json", namespace="/robot_$serial")
    write_description(tmp_path / "relbot.json", node="RELbot_node")
    write_description(tmp_path / "crane.json", node="crane", transport="uart0")
    for name in ("sim1", "sim2"):
        write_description(tmp_path / f"{name}.json", node=name, transport="udp")
    return tmp_path


ALL = [f"{name}.json" for name in ("jiwy", "relbot", "crane", "sim1", "sim2")]
WIRING = ["--board", f"jiwy={FIRST}", "--board", f"jiwy={SECOND}", "--board", "relbot=e6614103e72b8c31"]
WIRING += ["--device", "crane=/dev/ttyAMA0:921600", "--port", "9999"]


def nodes(source: str) -> list[dict[str, Any]]:
    """The ``Node(...)`` calls of a launch file: their keywords, with ``verbosity`` as a name."""
    found = []
    for call in ast.walk(ast.parse(source)):
        if isinstance(call, ast.Call) and isinstance(call.func, ast.Name) and call.func.id == "Node":
            found.append({keyword.arg: value(keyword.value) for keyword in call.keywords if keyword.arg is not None})
    return found


def value(node: ast.expr) -> object:
    if isinstance(node, ast.List):
        return [value(element) for element in node.elts]
    if isinstance(node, ast.Call):
        return ast.unparse(node)
    return node.id if isinstance(node, ast.Name) else ast.literal_eval(node)


def test_one_agent_for_each_board_and_one_for_all_by_udp(robots: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["launch", *ALL, *WIRING]) == 0
    assert capsys.readouterr().err == ""
    source = (robots / "agents.launch.py").read_text(encoding="utf-8")
    serial = ["serial", "-b"]
    assert [node["arguments"] for node in nodes(source)] == [
        [*serial, "115200", "--dev", BY_ID.format(FIRST), "verbosity"],
        [*serial, "115200", "--dev", BY_ID.format(SECOND), "verbosity"],
        [*serial, "115200", "--dev", BY_ID.format("E6614103E72B8C31"), "verbosity"],
        [*serial, "921600", "--dev", "/dev/ttyAMA0", "verbosity"],
        ["udp4", "-p", "9999", "verbosity"],
    ]
    for node in nodes(source):
        assert (node["package"], node["executable"]) == ("micro_ros_agent", "micro_ros_agent")
        assert node["respawn"] is True
    assert len({node["name"] for node in nodes(source)}) == 5
    assert f"# /robot_{FIRST}/JIWY_node: subscribes to /robot_{FIRST}/pan_subscriber" in source
    compile(source, "agents.launch.py", "exec")


def test_the_name_of_a_board_is_that_of_its_descriptors() -> None:
    """udev composes the name from manufacturer, product and serial number; both port layers have those of the chip."""
    source = (data_folder("targets") / "families/rp2/usb/include/tusb_config.h").read_text(encoding="utf-8")
    texts = dict(re.findall(r'#define EPG_PICO_USB_(\w+) "([^"]*)"', source))
    numbers = {name: int(text, 16) for name, text in re.findall(r"#define EPG_PICO_USB_(\w+) (0x\w+)", source)}
    options = (ROOT / "zephyr_module/Kconfig.epg").read_text(encoding="utf-8")
    of_zephyr = re.findall(r'default "?(.+?)"? if SOC_(?:FAMILY_RPI_PICO|SERIES_RP2040)', options)
    catalog = load_catalog(targets_roots(), Diagnostics())
    for board, product_id in (("rpi_pico", 0x000A), ("rpi_pico2", 0x0009)):
        target = catalog.find_target(f"{board}_zephyr")
        assert target is not None
        device = target.soc.usb_device
        assert (device["manufacturer"], device["product"]) == (texts["MANUFACTURER"], texts["PRODUCT"])
        assert (device["vendor_id"], numbers["PRODUCT_ID"], device["product_id"]) == (
            numbers["VENDOR_ID"],
            9,
            product_id,
        )
        assert {f"0x{device['vendor_id']:04x}", f"0x{product_id:04x}", *texts.values()} <= set(of_zephyr)
    product = f"usb-{texts['MANUFACTURER']}_{texts['PRODUCT']}".replace(" ", "_")
    assert BY_ID.format(FIRST) == f"/dev/serial/by-id/{product}_{FIRST}-if00"


def test_a_nucleo_on_usb(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """The names are those that the family gives to its USB device; the serial number has 96 bits."""
    tcf = tmp_path / "jiwy.tcf"
    tcf.write_text("version: 1\nextends: nucleo_h743zi_bare_metal_jiwy.tcf\ncommunication: {transport: usb}\n")
    example = ROOT / "examples/jiwy"
    files = ["--tcf", str(tcf), "--model", str(example / "model"), "--bindings", str(example / "jiwy.bindings.yaml")]
    assert main(["generate", "jiwy", *files, "--output", str(tmp_path / "epg")]) == 0
    launch = ["launch", str(tmp_path / "epg/jiwy.json"), "--output", str(tmp_path / "out"), "--systemd", "--board"]
    assert main([*launch, f"jiwy={FIRST}"]) != 0
    assert "the serial number of a board nucleo_h743zi has 24 hexadecimal digits" in capsys.readouterr().err
    assert main([*launch, "jiwy=003A002C3533510B31373835"]) == 0
    text = (tmp_path / "out" / "agents.launch.py").read_text(encoding="utf-8")
    assert '"/dev/serial/by-id/usb-STMicroelectronics_STM32_003A002C3533510B31373835-if00"' in text
    rules = next((tmp_path / "out").glob("**/*.rules")).read_text(encoding="utf-8")
    assert 'ATTRS{idVendor}=="0483"' in rules


@pytest.mark.parametrize("target", ["rpi_pico_bare_metal", "rpi_pico2_freertos", "rpi_pico_zephyr"])
def test_a_generated_pico_on_usb(target: str, tmp_path: Path) -> None:
    """Its names come from the chip's data, on each platform."""
    example = ROOT / "examples/jiwy"
    files = ["--model", str(example / "model"), "--bindings", str(example / "jiwy.bindings.yaml")]
    generate = ["generate", "jiwy", "--tcf", f"{target}_jiwy.tcf", *files, "--output", str(tmp_path / "epg")]
    assert main(generate) == 0
    launch = ["launch", str(tmp_path / "epg/jiwy.json"), "--output", str(tmp_path), "--board", f"jiwy={FIRST}"]
    assert main([*launch, "--systemd"]) == 0
    (node,) = nodes((tmp_path / "agents.launch.py").read_text(encoding="utf-8"))
    assert (node["package"], node["arguments"][4]) == ("micro_ros_agent", BY_ID.format(FIRST))
    assert 'ATTRS{idVendor}=="2e8a"' in (tmp_path / "systemd/70-epg-boards.rules").read_text(encoding="utf-8")


@pytest.mark.parametrize(
    ("missing", "message", "hint"),
    [
        (
            "agent",
            "'communication.agent' is missing, as in files of an older EPG",
            "configure the project again: CMake",
        ),
        (
            "usb",
            "the tty of this computer is not known",
            "configure its project again if an older EPG did so; otherwise",
        ),
    ],
)
def test_a_description_of_an_older_epg_is_explained(
    missing: str, message: str, hint: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = write_description(tmp_path / "jiwy.json")
    data = json.loads(file.read_text(encoding="utf-8"))
    del data["communication"][missing]
    file.write_text(json.dumps(data), encoding="utf-8")
    launch = ["launch", str(file), "--output", str(tmp_path / "out")]
    assert main([*launch, "--board", f"jiwy={FIRST}"]) == 1
    said = capsys.readouterr().err
    assert message in said and f"hint: {hint}" in said
    assert main([*launch, "--device", "jiwy=/dev/ttyACM0"]) == (1 if missing == "agent" else 0)
    assert main(["describe", str(file), "--plotjuggler", "--output", str(tmp_path / "plots")]) == 0, (
        "only agents need it"
    )


def test_two_agents_on_one_port_are_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    files = [write_description(tmp_path / f"{name}.json", node=name, transport="udp") for name in ("pan", "tilt")]
    files[1].write_text(files[1].read_text(encoding="utf-8").replace("micro_ros_agent", "other_agent"))
    assert main(["launch", *map(str, files), "--output", str(tmp_path / "out")]) == 1
    assert "UDP port 8888 is used by more than one agent: 'pan', 'tilt'" in capsys.readouterr().err


def test_a_board_with_names_of_its_own(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    usb = {"manufacturer": "Robots & Sons", "product": "Turn  table", "serial": "7", "vendor_id": 0x1209}
    file = write_description(tmp_path / "jiwy.json", usb=usb)
    launch = ["launch", str(file), "--output", str(tmp_path / "out"), "--systemd"]
    assert main([*launch, "--board", "jiwy=7"]) == 0
    text = (tmp_path / "out" / "agents.launch.py").read_text(encoding="utf-8")
    assert '"/dev/serial/by-id/usb-Robots___Sons_Turn_table_7-if00"' in text
    (rules,) = (tmp_path / "out" / "systemd").glob("*.rules")
    assert 'ATTRS{idVendor}=="1209", ATTRS{serial}=="7"' in rules.read_text(encoding="utf-8")
    assert main([*launch, "--board", "jiwy=8"]) != 0
    assert "'8' is not the serial number of 'jiwy'" in capsys.readouterr().err


def test_host_programs_with_names_and_agent(robots: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """A program of UDP uses the agent that the same file starts."""
    (robots / "build").mkdir()
    for name in ("sim", "other"):
        (robots / "build" / name).touch()
    host = {"board": "host", "platform": "host"}
    write_description(robots / "sim1.json", node="sim", namespace="/lab/r_$serial", transport="udp", target=host)
    write_description(robots / "arm.json", node="arm", middleware="dds", transport=None, target=host)
    programs = ["--program", "sim1=build/sim", "--program", f"arm={robots / 'build/other'}"]
    remaps = ["--remap", "sim1=pan_subscriber:=/joystick/pan", "--remap", "sim1=pan_publisher:=pan"]
    options = ["--port", "9999", "--output", "launch"]
    assert main(["launch", "sim1.json", "arm.json", *programs, *remaps, *options]) == 0
    assert capsys.readouterr().err == ""
    source = (robots / "launch/agents.launch.py").read_text(encoding="utf-8")
    compile(source, "agents.launch.py", "exec")
    agent, sim, arm = nodes(source)
    assert agent["arguments"] == ["udp4", "-p", "9999", "verbosity"]
    assert sim == {
        "executable": "PathJoinSubstitution([ThisLaunchFileDir(), '../build/sim'])",
        "name": "sim",
        "namespace": "LaunchConfiguration('sim1_namespace')",
        "arguments": ["--agent", "127.0.0.1:9999"],
        "remappings": [("pan_subscriber", "/joystick/pan"), ("pan_publisher", "pan")],
        "output": "screen",
    }
    assert (arm["executable"], arm["namespace"]) == (
        str(robots / "build/other"),
        "LaunchConfiguration('arm_namespace')",
    )
    assert 'DeclareLaunchArgument("sim1_namespace", default_value="lab/r_host"' in source
    assert 'DeclareLaunchArgument("arm_namespace", default_value=""' in source
    assert source.count("**END") == 3, "whatever hangs is ended"


def test_two_programs_of_one_target_have_the_same_node(robots: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (robots / "arm").touch()
    host = {"board": "host", "platform": "host"}
    write_description(robots / "arm.json", middleware="dds", transport=None, namespace="/r_$serial", target=host)
    assert main(["launch", "arm.json", "--program", "arm=arm", "--program", "arm=arm"]) == 0
    assert "2 robots have the same node '/r_host/JIWY_node'" in capsys.readouterr().err
    source = (robots / "agents.launch.py").read_text(encoding="utf-8")
    assert "[arm_namespace:=robot_2] [arm_2_namespace:=robot_2]" in source
    assert main(["launch", "arm.json", "--program", "arm=arm", "--systemd"]) == 1
    assert "services are for agents, not for host programs" in capsys.readouterr().err


def test_the_launch_file_starts_where_ros_is(robots: Path) -> None:
    if importlib.util.find_spec("launch_ros") is None:
        pytest.skip("ROS 2 is not sourced: install ROS 2 Jazzy and '. /opt/ros/jazzy/setup.bash'")
    assert main(["launch", *ALL, *WIRING]) == 0
    done = subprocess.run(["ros2", "launch", "./agents.launch.py", "--show-args"], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert "verbosity" in done.stdout


def test_the_same_again_changes_nothing_and_nothing_is_overwritten(
    robots: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    command = ["launch", "relbot.json", "--board", f"relbot={FIRST}", "--systemd"]
    assert main(command) == 0
    files = {path: path.read_bytes() for path in robots.rglob("*") if path.is_file()}
    assert main(command) == 0
    assert {path: path.read_bytes() for path in robots.rglob("*") if path.is_file()} == files

    (robots / "agents.launch.py").write_text("# mine\n", encoding="utf-8")
    capsys.readouterr()
    assert main(["launch", "relbot.json", "--board", f"relbot={SECOND}", "--systemd"]) == 1
    assert "agents.launch.py: error: this file exists [file-exists]" in capsys.readouterr().err
    assert (robots / "agents.launch.py").read_text(encoding="utf-8") == "# mine\n"
    assert not list(robots.glob(f"systemd/*{SECOND}*")), "all files or none"
    assert main([*command, "--force"]) == 0
    assert {path: path.read_bytes() for path in robots.rglob("*") if path.is_file()} == files


def test_a_build_folder_stands_for_its_targets(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    write_description(tmp_path / "build/epg/pan/pan.json", transport="udp")
    write_description(tmp_path / "build/sub/epg/tilt/tilt.json", node="tilt", transport="udp")
    (tmp_path / "build/epg/pan/other.json").write_text("[1, 2]", encoding="utf-8")
    assert main(["launch", str(tmp_path / "build"), "--output", str(tmp_path), "--json"]) == 0
    assert '"/JIWY_node",\n        "/tilt"' in capsys.readouterr().out


def units(folder: Path) -> dict[str, dict[str, str]]:
    """The settings of each unit file, with those of all sections together (no name occurs in two)."""
    found = {}
    for path in sorted(folder.glob("*.service")):
        lines = path.read_text(encoding="utf-8").splitlines()
        found[path.name] = dict(line.split("=", 1) for line in lines if "=" in line and not line.startswith("#"))
    return found


def test_units_are_bound_to_their_boards(robots: Path) -> None:
    assert main(["launch", *ALL, *WIRING, "--systemd", "--domain", "7", "--user", "robot"]) == 0
    found = units(robots / "systemd")
    assert len(found) == 5
    one = found[f"epg-agent-jiwy-{FIRST}.service"]
    device = device_unit(BY_ID.format(FIRST))
    assert one["BindsTo"] == one["WantedBy"] == device
    assert device in one["After"].split()
    assert (one["Restart"], one["User"], one["SupplementaryGroups"]) == ("always", "robot", "dialout")
    assert one["Environment"] == "ROS_DOMAIN_ID=7 XRCE_DOMAIN_ID_OVERRIDE=7"
    udp = found["epg-agent-udp-9999.service"]
    assert "BindsTo" not in udp
    assert udp["WantedBy"] == "multi-user.target"

    readme = (robots / "systemd/README.md").read_text(encoding="utf-8")
    for unit in found:
        assert f"`{unit}`" in readme
    rules = (robots / "systemd/70-epg-boards.rules").read_text(encoding="utf-8").splitlines()
    assert [re.findall(r'ATTRS\{serial\}=="(\w+)"', rule) for rule in rules[1:]] == [
        [FIRST],
        [SECOND],
        ["E6614103E72B8C31"],
    ]


def test_the_command_of_a_unit_survives_systemd_and_bash(robots: Path) -> None:
    """systemd removes quotes and expands % and $; then bash splits the line."""
    workspace = '/home/a b/50% $HOME "quoted" it\'s'
    assert main(["launch", "relbot.json", "--board", f"relbot={FIRST}", "--systemd", "--workspace", workspace]) == 0
    (unit,) = units(robots / "systemd").values()
    shell, option, quoted = unit["ExecStart"].split(" ", 2)
    assert (shell, option, quoted[0], quoted[-1]) == ("/bin/bash", "-c", '"', '"')
    script = re.sub(r'\\(["\\])', r"\1", quoted[1:-1]).replace("%%", "%").replace("$$", "$")
    words = [shlex.split(step) for step in script.split(" && ")]
    assert words == [
        [".", "/opt/ros/jazzy/setup.bash"],
        [".", f"{workspace}/install/local_setup.bash"],
        f"exec ros2 run micro_ros_agent micro_ros_agent serial -b 115200 --dev {BY_ID.format(FIRST)}".split(),
    ]


def test_systemd_finds_nothing_wrong(robots: Path) -> None:
    if shutil.which("systemd-analyze") is None:
        pytest.skip("systemd is not installed: sudo apt install systemd")
    assert main(["launch", *ALL, *WIRING, "--systemd", "--workspace", "/home/a b/50%"]) == 0
    files = sorted((robots / "systemd").glob("*.service"))
    done = subprocess.run(["systemd-analyze", "verify", *files], capture_output=True, text=True)
    assert (done.returncode, done.stderr) == (0, "")

    files[0].write_text(files[0].read_text(encoding="utf-8").replace("Restart=always", "Restart=often"))
    done = subprocess.run(["systemd-analyze", "verify", files[0]], capture_output=True, text=True)
    assert "often" in done.stderr, "systemd-analyze would have told"


@pytest.mark.parametrize("path", [BY_ID.format(FIRST), "/dev/ttyAMA0", "/dev//a b/", "/dev/.x-é", "/.dev/x:y_z"])
def test_names_of_device_units_are_systemds(path: str) -> None:
    if shutil.which("systemd-escape") is None:
        pytest.skip("systemd is not installed: sudo apt install systemd")
    done = subprocess.run(
        ["systemd-escape", "--path", "--suffix=device", path], capture_output=True, text=True, check=True
    )
    assert device_unit(path) == done.stdout.strip()


HOSTILE = [
    "x\nUser=root",
    'x"""\nimport os; os.system("touch pwned")\n"""',
    "x\r[Service]",
    "x\u2028y",
    "%n",
    "$(touch pwned)",
    "x\\",
    "x'y",
    "</node>",
    "a b",
]


@pytest.mark.parametrize("text", HOSTILE, ids=repr)
@pytest.mark.parametrize(
    "key", ["name", "node", "namespace", "topic", "board", "middleware", "agent", "transport", "domain"]
)
def test_names_that_epg_would_not_write_are_not_read(
    key: str, text: str, robots: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """A build folder may come from anyone, and its texts would be in a program and in files for root."""
    file = robots / "relbot.json"
    data = json.loads(file.read_text(encoding="utf-8"))
    place = {"topic": data["publications"][0], "board": data["target"]}.get(key, data)
    place = data["communication"] if key in ("middleware", "agent", "transport", "domain") else place
    place[key] = text
    file.write_text(json.dumps(data), encoding="utf-8")
    assert main(["launch", "relbot.json", "--board", f"relbot={FIRST}", "--systemd"]) == 1
    assert "relbot.json: error: this description of a target is damaged: '" in (said := capsys.readouterr().err)
    assert "[description-damaged]" in said
    assert not list(robots.rglob("*.service")) and not list(robots.glob("*.py"))


@pytest.mark.parametrize("text", [*HOSTILE, ""], ids=repr)
@pytest.mark.parametrize("option", ["--user", "--distribution"])
def test_options_are_names(option: str, text: str, robots: Path) -> None:
    assert main(["launch", "relbot.json", "--board", f"relbot={FIRST}", "--systemd", option, text]) == 2
    assert not list(robots.rglob("*.service"))


@pytest.mark.parametrize("text", HOSTILE, ids=repr)
def test_paths_are_one_word_wherever_they_stand(text: str, robots: Path) -> None:
    """A device and a workspace may have any name without a line end."""
    options = ["--device", f"crane=/dev/{text}", "--systemd", "--workspace", f"/home/{text}"]
    status = main(["launch", "crane.json", *options])
    if not text.isprintable():
        assert status in (1, 2) and not list(robots.rglob("*.service"))
        return
    assert status == 0
    (node,) = nodes((robots / "agents.launch.py").read_text(encoding="utf-8"))
    assert node["arguments"][:5] == ["serial", "-b", "115200", "--dev", f"/dev/{text}"]
    (unit,) = units(robots / "systemd").values()
    assert unit["User"] == "ubuntu" and unit["BindsTo"] == device_unit(f"/dev/{text}")
    quoted = unit["ExecStart"].split(" ", 2)[2]
    script = re.sub(r'\\(["\\])', r"\1", quoted[1:-1]).replace("%%", "%").replace("$$", "$")
    words = [shlex.split(step) for step in script.split(" && ")]
    assert words[1] == [".", f"/home/{text}/install/local_setup.bash"] and words[2][-1] == f"/dev/{text}"
    if shutil.which("systemd-analyze") is not None:
        files = sorted((robots / "systemd").glob("*.service"))
        done = subprocess.run(["systemd-analyze", "verify", *files], capture_output=True, text=True)
        assert (done.returncode, done.stderr) == (0, "")


@pytest.mark.parametrize(
    ("given", "passed"),
    [("com3", "COM3"), ("COM12:921600", r"\\.\COM12"), (r"\\.\COM3", "COM3"), (r"\\.\com12", r"\\.\COM12")],
)
def test_a_port_of_windows(given: str, passed: str, robots: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["launch", "crane.json", "--device", f"crane={given}"]) == 0
    (node,) = nodes((robots / "agents.launch.py").read_text())
    rate = "921600" if ":" in given else "115200"
    assert node["arguments"][:5] == ["serial", "-b", rate, "--dev", passed]
    assert node["name"] == f"agent_crane_COM{passed.partition('COM')[2]}"
    assert "run the agent in WSL2" in capsys.readouterr().err
