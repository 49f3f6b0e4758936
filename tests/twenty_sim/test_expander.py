# SPDX-License-Identifier: Apache-2.0
"""The token language, as in public exports and templates."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.doubles.twenty_sim.expander import expand, read_targets

TOKENS = {
    "NUMBER_STATES": "2",
    "NUMBER_INPUTS": "0",
    "EMPTY": "",
    "METHOD": "Euler",
    "NAME": "Servo",
    "BIG": "\ta\n\tb\n",
}


@pytest.mark.parametrize(
    ("template", "text"),
    [
        ("%NAME%_V %VARIABLE%NAME%", "Servo_V %VARIABLE%NAME%"),
        ("a\n%IF%%NUMBER_STATES%\nb\n%ENDIF%\nc\n", "a\nb\nc\n"),
        ("a\n%IF%%NUMBER_INPUTS%\nb\n%ELSE%\nd\n%ENDIF%\nc\n", "a\nd\nc\n"),
        ("%IF%%EMPTY%x%ENDIF%%IF%%MISSING%y%ENDIF%z", "z"),
        ("f(%IF%%NUMBER_STATES%\ndouble *u, %ENDIF%\nint t)\n", "f(\ndouble *u, \nint t)\n"),
        ("%IF%%NUMBER_STATES%\n%IF%%NUMBER_INPUTS%\na\n%ELSE%\nb\n%ENDIF%\n%ELSE%\nc\n%ENDIF%\n", "b\n"),
        ("%IF%%NUMBER_INPUTS%\n%IF%%NUMBER_STATES%\na\n%ELSE%\nb\n%ENDIF%\n%ELSE%\nc\n%ENDIF%\n", "c\n"),
        ("%IF%%OR(NUMBER_INPUTS, NUMBER_STATES)%\na\n%ENDIF%\n", "a\n"),
        ("%IF%%AND(NUMBER_INPUTS,NUMBER_STATES)%\na\n%ENDIF%\n", ""),
        ("%IF%%EQ(METHOD,Euler)%\na\n%ENDIF%\n%IF%%NEQ(METHOD,Euler)%\nb\n%ENDIF%\n", "a\n"),
        ("%IF%%NOT(EQ(METHOD,MeBDFi))%\na\n%ENDIF%\n", "a\n"),
        ("%IF%%NUMBER_STATES%\n\t%ENDIF%\nrest", "rest"),
        ("%IF%%NUMBER_STATES%\n%BIG%%ENDIF%", "\ta\n\tb\n"),
        ('if "%PATH%"=="" echo %~dp0.\n', 'if "%PATH%"=="" echo %~dp0.\n'),
    ],
)
def test_expansion(template: str, text: str) -> None:
    assert expand(template, TOKENS) == text


@pytest.mark.parametrize("template", ["%IF%%NAME%\n", "%ENDIF%\n", "%ELSE%\n", "%IF%%XOR(NAME,NAME)%\n%ENDIF%\n"])
def test_marks_that_do_not_pair(template: str) -> None:
    with pytest.raises(ValueError):
        expand(template, TOKENS)


def test_targets(tmp_path: Path) -> None:
    path = tmp_path / "Targets.ini"
    path.write_text(
        "; a list\n[targets]\nB\nA\n[A]\ntargetName=a\n%X%=1\n[B]\ntemplateFiles=a.c;src\\%NAME%.h\n"
        'templateFiles="c.txt"\n%V%=\nnewLineCharacter=2\n',
        encoding="utf-8",
    )
    for name, text in (("a.c", "%V%|%NAME%|%FILE_NAME%\r\n"), ("src/%NAME%.h", "h"), ("c.txt", "%TOKENS%")):
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_bytes(text.encode())
    targets = read_targets(path)
    assert list(targets) == ["B", "A"] and targets["A"].tokens == {"X": "1"}
    written = targets["B"].generate({"NAME": "Servo", "V": "xx_"}, tmp_path / "out")
    assert [path.relative_to(tmp_path / "out").as_posix() for path in written] == ["a.c", "src/Servo.h", "c.txt"]
    assert written[0].read_bytes() == b"|Servo|a.c\n"
    assert b'<token name="V"><![CDATA[]]></token>' in written[2].read_bytes()
