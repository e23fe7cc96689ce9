import io
import json
from pathlib import Path, PureWindowsPath
from types import SimpleNamespace

import pytest

from elitescript.cli.main import main
from elitescript.cli.output.check_formats import artifact_location

GOOD = "def a():\n  sleep(1)\nend\n"
BAD = "def a():\n  sleep(-1)\nend\n"
OLD = 'def a():\n  print "x"\n  if 1 <> 2 && True:\n    textmsg("hi")\n  end\nend\n'
REPAIRED = 'def a():\n  print("x")\n  if 1 != 2 and True:\n    textmsg("hi")\n  end\nend\n'


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)

    def write(**files):
        for name, text in files.items():
            path = tmp_path / name.replace("__", "/").replace("_script", ".script")
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_bytes(text if isinstance(text, bytes) else text.encode())
        return tmp_path

    return write


@pytest.fixture
def stdin(monkeypatch):
    def feed(data):
        monkeypatch.setattr("sys.stdin", SimpleNamespace(buffer=io.BytesIO(data)))

    return feed


class TestWhatIsChecked:
    def test_a_folder_with_everything_below_it_by_name(self, folder, capsys):
        folder(z__b_script=BAD, z__a_script=BAD, c_script=BAD, note_txt=BAD, **{".git__d_script": BAD})
        assert main(["check", "--json", "."]) == 3
        captured = capsys.readouterr()
        files = [json.loads(line)["file"] for line in captured.out.splitlines()]
        assert [Path(file).as_posix() for file in files] == ["c.script", "z/a.script", "z/b.script"]
        assert captured.err == "3 files checked: 3 errors, 0 warnings\n"

    def test_each_file_once(self, folder, capsys):
        folder(a_script=BAD)
        main(["check", "a.script", ".", "a.script"])
        assert "1 file checked: 1 error" in capsys.readouterr().err

    def test_standard_input(self, stdin, capsys):
        stdin(BAD.encode())
        assert main(["check", "-"]) == 3
        assert capsys.readouterr().out.startswith("<stdin>:2:9: error E305: ")

    def test_a_file_that_is_missing_is_said_and_the_others_are_checked(self, folder, capsys):
        folder(cell_script=BAD)
        assert main(["check", "cell.scrpt", "cell.script"]) == 2
        output = capsys.readouterr().out
        assert output.startswith("cell.scrpt:1:1: error E003: cannot read cell.scrpt: No such file or directory\n")
        assert "hint: is cell.script meant?" in output
        assert "cell.script:2:9: error E305" in output

    def test_a_binary_file_in_a_folder_is_an_error_at_its_byte(self, folder, capsys):
        folder(a_script=b"def a():\n\xff\xfe\x00", b_script=BAD)
        assert main(["check", "."]) == 3
        output = capsys.readouterr().out
        assert "a.script:2:1: error E002: byte 0xFF is not UTF-8 text" in output
        assert "b.script:2:9: error E305" in output

    @pytest.mark.parametrize(("codec", "name"), [("gbk", "GBK"), ("utf-16", "UTF-16"), ("utf-16-le", "UTF-16")])
    def test_other_encodings_are_named_and_converted(self, folder, capsys, codec, name):
        text = "def a():\r\n  # 移动到原点\r\n  textmsg(“完成\uff1a”\uff09\r\nend\r\n"
        path = folder(a_script=text.replace("“", '"').replace("”", '"').encode(codec)) / "a.script"
        before = path.read_bytes()
        assert main(["check", "a.script"]) == 3
        output = capsys.readouterr().out
        assert f"error E002: the text is {name}, not UTF-8: this line reads `" in output
        assert ("# 移动到原点" in output) == (name == "GBK")
        assert "hint: `elitescript check --fix` converts the file to UTF-8" in output
        assert path.read_bytes() == before
        assert main(["check", "--fix", "a.script"]) == 0
        assert f"convert the file from {name} to UTF-8" in "".join(capsys.readouterr())
        assert path.read_bytes().decode() == 'def a():\r\n  # 移动到原点\r\n  textmsg("完成\uff1a")\r\nend\r\n'

    def test_what_is_in_an_unknown_encoding_stays(self, folder):
        path = folder(a_script=b"def a():\n textmsg('\xff')\nend\n") / "a.script"
        before = path.read_bytes()
        assert main(["check", "--fix", "a.script"]) == 3
        assert path.read_bytes() == before

    def test_a_folder_without_programs(self, folder, capsys):
        folder(note_txt="x")
        assert main(["check", "."]) == 2
        assert "no *.script file in this folder" in capsys.readouterr().out

    @pytest.mark.parametrize("command", [["check"], ["fmt", "--check"]])
    def test_names_in_capitals_are_programs_and_links_are_no_second_ones(self, folder, capsys, command):
        home = folder(**{"CELL.SCRIPT": "def a():\n sleep(1)\nend\n", "b.Script": "def b():\n sleep(1)\nend\n"})
        (home / "alias.script").symlink_to("CELL.SCRIPT")
        (home / "round").symlink_to(".", target_is_directory=True)
        main([*command, "."])
        out, err = capsys.readouterr()
        assert "2 files" in err, out

    def test_nothing_at_all_is_a_usage_error(self, capsys):
        assert main(["check"]) == 2
        assert main(["check", "--json", "--format", "sarif", "x.script"]) == 2
        assert main(["check", "--fix", "-", "x.script"]) == 2

    def test_warnings_alone_are_no_errors(self, folder):
        folder(a_script="def a():\n  while True:\n    pass\n  end\nend\n")
        assert main(["check", "a.script"]) == 0


class TestFix:
    def test_safe_repairs_are_made_and_named(self, folder, capsys):
        path = folder(a_script=OLD) / "a.script"
        assert main(["check", "--fix", "a.script"]) == 0
        assert path.read_text() == REPAIRED
        captured = capsys.readouterr()
        assert captured.out.splitlines() == [
            "a.script:2: repaired E106: write print(...)",
            "a.script:3: repaired E111: write !=",
            "a.script:3: repaired E113: write `and`",
        ]
        assert captured.err == "1 file checked: 0 errors, 0 warnings, 3 repairs\n"

    def test_a_second_time_nothing_changes(self, folder, capsys):
        path = folder(a_script=OLD) / "a.script"
        main(["check", "--fix", "a.script"])
        before = path.stat()
        capsys.readouterr()
        main(["check", "--fix", "a.script"])
        assert capsys.readouterr().out == ""
        assert (path.stat().st_ino, path.stat().st_mtime_ns) == (before.st_ino, before.st_mtime_ns)

    @pytest.mark.parametrize("line_end", ["\r\n", "\r", "\n"])
    def test_line_ends_and_byte_order_mark_stay(self, folder, line_end):
        text = ("\ufeff" + OLD.replace("hi", "坐标")).replace("\n", line_end)
        path = folder(a_script=text) / "a.script"
        main(["check", "--fix", "a.script"])
        assert path.read_bytes().decode() == ("\ufeff" + REPAIRED.replace("hi", "坐标")).replace("\n", line_end)

    def test_an_inserted_line_ends_like_the_others(self, folder):
        text = "def a():\r\n  n = 1\r\n  global n\r\nend\r\n"
        path = folder(a_script=text) / "a.script"
        main(["check", "--fix", "a.script"])
        assert b"\n" not in path.read_bytes().replace(b"\r\n", b"")
        assert path.read_bytes().startswith(b"def a():\r\n  global n\r\n  n = 1\r\n")

    def test_a_guess_is_not_made(self, folder):
        text = "def a():\n  texmsg(1)\nend\n"
        path = folder(a_script=text) / "a.script"
        assert main(["check", "--fix", "a.script"]) == 3
        assert path.read_text() == text

    def test_permissions_stay_and_nothing_is_left_beside(self, folder):
        home = folder(a_script=OLD)
        (home / "a.script").chmod(0o640)
        main(["check", "--fix", "a.script"])
        assert (home / "a.script").stat().st_mode & 0o777 == 0o640
        assert [path.name for path in home.iterdir()] == ["a.script"]

    def test_standard_input_comes_out_repaired_and_the_report_goes_beside(self, stdin, capfdbinary):
        stdin(OLD.replace("\n", "\r\n").encode())
        assert main(["check", "--fix", "-"]) == 0
        captured = capfdbinary.readouterr()
        assert captured.out.decode() == REPAIRED.replace("\n", "\r\n")
        assert b"<stdin>:2: repaired E106" in captured.err

    def test_json_has_a_record_for_each_repair(self, folder, capsys):
        folder(a_script=OLD)
        main(["check", "--fix", "--json", "a.script"])
        records = [json.loads(line) for line in capsys.readouterr().out.splitlines()]
        assert records[0] == {
            "file": "a.script",
            "type": "fix",
            "code": "E106",
            "line": 2,
            "text": "write print(...)",
        }


class TestFormats:
    def test_json_is_that_of_the_option(self, folder, capsys):
        folder(a_script=BAD)
        main(["check", "--json", "a.script"])
        lines = capsys.readouterr().out
        main(["check", "--format", "json", "a.script"])
        assert capsys.readouterr().out == lines

    def test_github_commands_are_escaped(self, folder, capsys):
        folder(**{"a,b: 100%_script": 'def a():\n  sleep("50%")\nend\n'})
        assert main(["check", "--format", "github", "."]) == 3
        (line,) = capsys.readouterr().out.splitlines()
        assert line == (
            "::error file=a%2Cb%3A 100%25.script,line=2,col=9,endLine=2,endColumn=14,title=E304 argument of the wrong "
            "type::sleep: t must be a number, not str '50%25'%0Ahint: it is called as sleep(t)"
        )

    def test_sarif_has_rules_with_help_and_results_with_regions_and_fixes(self, folder, capsys):
        folder(**{"my cell__a_script": "def a():\n  if 1 && 2:\n    sleep(-1)\n  end\nend\n"})
        assert main(["check", "--format", "sarif", "."]) == 3
        log = json.loads(capsys.readouterr().out)
        assert (log["version"], log["$schema"]) == ("2.1.0", "https://json.schemastore.org/sarif-2.1.0.json")
        (run,) = log["runs"]
        rules = run["tool"]["driver"]["rules"]
        assert [rule["id"] for rule in rules] == [result["ruleId"] for result in run["results"]] == ["E113", "E305"]
        assert all(rule["help"]["text"] and rule["defaultConfiguration"]["level"] == "error" for rule in rules)
        first = run["results"][0]
        assert (first["ruleIndex"], first["level"]) == (0, "error")
        place = first["locations"][0]["physicalLocation"]
        assert place["artifactLocation"] == {"uri": "my%20cell/a.script", "uriBaseId": "%SRCROOT%"}
        assert place["region"] == {"startLine": 2, "startColumn": 8, "endLine": 2, "endColumn": 10}
        (change,) = first["fixes"][0]["artifactChanges"]
        assert change["replacements"] == [
            {
                "deletedRegion": {"startLine": 2, "startColumn": 8, "endLine": 2, "endColumn": 10},
                "insertedContent": {"text": "and"},
            }
        ]

    @pytest.mark.parametrize("by", ["variable", "git"])
    @pytest.mark.parametrize(
        ("name", "shown", "uri"),
        [
            ("bad.script", "robot/bad.script", "robot/bad.script"),
            ("CELL.SCRIPT", "robot/CELL.SCRIPT", "robot/CELL.SCRIPT"),
            ("a b#1?.script", "robot/a b#1?.script", "robot/a%20b%231%3F.script"),
            ("100%:ä.script", "robot/100%25%3Aä.script", "robot/100%25%3A%C3%A4.script"),
            ("b\udce9d.script", "robot/b\\udce9d.script", "robot/b%E9d.script"),
            ("in/x.script", "robot/in/x.script", "robot/in/x.script"),
        ],
    )
    def test_findings_of_a_job_in_a_sub_folder_are_named_from_the_root(
        self, tmp_path, monkeypatch, capfd, name, shown, uri, by
    ):
        home = tmp_path / "my repo"
        path = home / "robot" / name
        path.parent.mkdir(parents=True)
        path.write_text(BAD)
        monkeypatch.chdir(home / "robot")
        if by == "variable":
            monkeypatch.setenv("GITHUB_WORKSPACE", str(home))
        else:
            monkeypatch.delenv("GITHUB_WORKSPACE", raising=False)
            (home / ".git").mkdir()
        assert main(["check", "--format", "github", "."]) == 3
        assert capfd.readouterr().out.startswith(f"::error file={shown},line=")
        assert main(["check", "--format", "sarif", str(path)]) == 3
        (run,) = json.loads(capfd.readouterr().out)["runs"]
        place = run["results"][0]["locations"][0]["physicalLocation"]["artifactLocation"]
        assert place == {"uri": uri, "uriBaseId": "%SRCROOT%"}
        assert run["originalUriBaseIds"] == {"%SRCROOT%": {"uri": f"{home.as_uri()}/"}}
        assert run["invocations"][0]["workingDirectory"] == {"uri": f"{(home / 'robot').as_uri()}/"}

    def test_findings_outside_of_the_root_have_absolute_paths(self, tmp_path, monkeypatch, capsys):
        (tmp_path / "repo").mkdir()
        other = tmp_path / "other one.script"
        other.write_text(BAD)
        monkeypatch.chdir(tmp_path / "repo")
        monkeypatch.setenv("GITHUB_WORKSPACE", str(tmp_path / "repo"))
        assert main(["check", "--format", "github", "../other one.script"]) == 3
        assert f"file={other}," in capsys.readouterr().out
        assert main(["check", "--format", "sarif", "../other one.script"]) == 3
        result = json.loads(capsys.readouterr().out)["runs"][0]["results"][0]
        assert result["locations"][0]["physicalLocation"]["artifactLocation"] == {"uri": other.as_uri()}

    def test_places_on_windows_have_slashes(self):
        assert artifact_location(PureWindowsPath("robot\\a b.script")) == {
            "uri": "robot/a%20b.script",
            "uriBaseId": "%SRCROOT%",
        }
        assert artifact_location(PureWindowsPath("D:\\other\\a b.script")) == {"uri": "file:///D:/other/a%20b.script"}

    def test_sarif_of_clean_files_is_a_log_too(self, folder, capsys):
        folder(a_script=GOOD)
        assert main(["check", "--format", "sarif", "a.script"]) == 0
        assert json.loads(capsys.readouterr().out)["runs"][0]["results"] == []


class TestExplain:
    def test_a_rule_is_explained_by_its_own_text(self, capsys):
        assert main(["check", "--explain", "w204"]) == 0
        output = capsys.readouterr().out
        assert output.startswith("W204: loop that never waits\nWarning; error with --strict. The program starts.")
        assert "write sync(), or sleep(0.01)" in output

    def test_alarms_are_explained_too(self, capsys):
        assert main(["check", "--explain", "R114"]) == 0
        assert "Two threads move the arm" in capsys.readouterr().out

    def test_an_unknown_code_is_a_usage_error(self, capsys):
        assert main(["check", "--explain", "E30"]) == 2
        assert "there is no code 'E30'; did you mean E30" in capsys.readouterr().err
