// The extension without an editor: `vscode` and the client library are fakes; processes and files are real.

import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { chmodSync, mkdirSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import * as os from "node:os";
import * as path from "node:path";
import { after, beforeEach, describe, test } from "node:test";
import { activate } from "../src/extension";
import { AdapterFactory, Configurations } from "../src/debugging";
import { PathPages } from "../src/path_page";
import { findElitescript, installCommand, robotOptions } from "../src/program";
import { namesIn, outcomesIn, ScriptTests } from "../src/script_tests";
import { keepCursor } from "../src/server";
import { Tasks } from "../src/tasks";
import { behaviour, started } from "./fake_client";
import { fake, Range, reset, Task, Uri } from "./fake_vscode";
import { describeGrammar } from "./grammar";

const HERE = process.cwd();
const ROOT = mkdtempSync(path.join(os.tmpdir(), "elitescript-vscode-"));
const ABOUT = JSON.parse(readFileSync(path.join(HERE, "package.json"), "utf8"));
const onPosix = { skip: process.platform === "win32" ? "the programs of this test are shell scripts" : false };

after(() => rmSync(ROOT, { recursive: true }));

let workspace = "";
let count = 0;

beforeEach(() => {
  reset();
  started.length = 0;
  behaviour.fails = false;
  workspace = path.join(ROOT, String((count += 1)));
  mkdirSync(workspace);
  fake.folders = [{ uri: Uri.file(workspace), name: "cell" }];
  process.env["PATH"] = "/usr/bin:/bin";
});

/** Writes a shell script into a folder of the workspace. */
function executable(file: string, text = "exit 0"): string {
  const whole = path.join(workspace, file);
  mkdirSync(path.dirname(whole), { recursive: true });
  writeFileSync(whole, `#!/bin/sh\n${text}\n`);
  chmodSync(whole, 0o755);
  return whole;
}

function program(name = "a.script"): any {
  const file = path.join(workspace, name);
  writeFileSync(file, "def a():\n  sleep(1)\nend\n");
  return Uri.file(file);
}

async function command(name: string, ...given: unknown[]): Promise<void> {
  await fake.commands.get(name)!(...given);
}

describe("the command elitescript", onPosix, () => {
  test("of the workspace comes first, then that of the selected Python, then that of the PATH", async () => {
    const onPath = executable("bin/elitescript");
    process.env["PATH"] = path.dirname(onPath);
    assert.equal((await findElitescript())?.command, onPath);
    const selected = executable("env/bin/elitescript");
    fake.python = path.join(workspace, "env/bin/python");
    assert.equal((await findElitescript())?.command, selected);
    const own = executable(".venv/bin/elitescript");
    assert.equal((await findElitescript())?.command, own);
  });

  test("is the one of the settings if they name one, from the folder of the workspace", async () => {
    executable(".venv/bin/elitescript");
    fake.settings["elitescript.path"] = "tools/elitescript";
    assert.equal((await findElitescript())?.command, path.join(workspace, "tools/elitescript"));
    fake.settings["elitescript.path"] = "elitescript";
    assert.equal((await findElitescript())?.command, "elitescript");
  });

  test("is no folder and no file that cannot be executed", async () => {
    mkdirSync(path.join(workspace, ".venv/bin/elitescript"), { recursive: true });
    chmodSync(executable("venv/bin/elitescript"), 0o644);
    assert.equal(await findElitescript(), undefined);
  });

  test("gets the settings as options", () => {
    assert.deepEqual(robotOptions(), []);
    Object.assign(fake.settings, { "elitescript.robot": "CS612", "elitescript.world": "cell.toml", "elitescript.strict": true });
    assert.deepEqual(robotOptions(), ["--robot", "CS612", "--world", "cell.toml", "--strict"]);
    // Only commands that run programs have it; others would refuse it.
    fake.settings["elitescript.network"] = "192.168.1.5:502";
    assert.deepEqual(robotOptions(undefined, "run").slice(4, 6), ["--network", "192.168.1.5:502"]);
    assert.ok(!robotOptions(undefined, "sweep").includes("--network"));
    delete fake.settings["elitescript.network"];
  });
});

describe("installing", () => {
  test("writes the command into a terminal, where the user confirms it", async () => {
    fake.python = "/opt/my env/bin/python";
    await activate({ subscriptions: [] } as any);
    await command("elitescript.install");
    assert.deepEqual(fake.terminals[0]?.sent, [['"/opt/my env/bin/python" -m pip install "elitescript[lsp]"', false]]);
  });

  test("is offered where there is no elitescript, once, and never done by itself", async () => {
    fake.answer = "Install in a terminal…";
    await activate({ subscriptions: [] } as any);
    await new Promise(setImmediate);
    assert.equal(fake.messages.length, 1);
    assert.match(fake.messages[0]!, /was found neither in the workspace's \.venv/);
    assert.deepEqual(fake.terminals[0]?.sent, [[await installCommand(), false]]);
    assert.deepEqual(started, []);
  });
});

describe("activation", onPosix, () => {
  test("registers every command of package.json and starts the server", async () => {
    const own = executable(".venv/bin/elitescript");
    await activate({ subscriptions: [] } as any);
    const contributed = ABOUT.contributes.commands.map((one: { command: string }) => one.command);
    assert.deepEqual([...fake.commands.keys()].sort(), contributed.sort());
    assert.deepEqual(started, [{ command: own, args: ["lsp"] }]);
  });

  test("runs nothing of a workspace that is not trusted, until it is", async () => {
    executable(".venv/bin/elitescript");
    fake.isTrusted = false;
    await activate({ subscriptions: [] } as any);
    assert.deepEqual([...fake.commands.keys()], ["elitescript.newProgram"]);
    assert.deepEqual(started, []);
    await fake.onTrusted.fire();
    assert.equal(started.length, 1);
  });

  test("starts another server when the path changes, and the same one not twice", async () => {
    executable(".venv/bin/elitescript");
    const other = executable("other/elitescript");
    await activate({ subscriptions: [] } as any);
    const change = { affectsConfiguration: (name: string) => name === "elitescript.path" };
    await fake.onSettings.fire(change);
    fake.settings["elitescript.path"] = other;
    await fake.onSettings.fire(change);
    await command("elitescript.restartServer");
    assert.deepEqual(started.map((server) => server.command), [path.join(workspace, ".venv/bin/elitescript"), other, other]);
  });

  test("says that the server does not start", async () => {
    executable(".venv/bin/elitescript");
    behaviour.fails = true;
    await activate({ subscriptions: [] } as any);
    assert.match(fake.messages[0]!, /does not start\. It needs `elitescript\[lsp\]`/);
  });
});

describe("debugging", onPosix, () => {
  test("starts `elitescript dap` in the folder of the workspace", async () => {
    const own = executable(".venv/bin/elitescript");
    const session = { configuration: { program: program().fsPath }, workspaceFolder: fake.folders[0] };
    const adapter: any = await new AdapterFactory().createDebugAdapterDescriptor(session as any);
    assert.deepEqual([adapter.command, adapter.args, adapter.options], [own, ["dap"], { cwd: workspace }]);
  });

  test("F5 without a launch.json debugs the program in the editor, and nothing else", () => {
    const configurations = new Configurations();
    assert.equal(configurations.resolveDebugConfiguration(undefined, {} as any), undefined);
    fake.active = { uri: program(), languageId: "elitescript" };
    assert.equal(configurations.resolveDebugConfiguration(undefined, {} as any)?.["program"], "${file}");
  });

  test("what it offers stays at the end, for a way back from there; what others write does so if it says so", () => {
    const configurations = new Configurations();
    fake.active = { uri: program(), languageId: "elitescript" };
    const { initialConfigurations, configurationSnippets } = ABOUT.contributes.debuggers[0];
    const offered = [
      configurations.resolveDebugConfiguration(undefined, {} as any),
      ...configurations.provideDebugConfigurations(),
      ...initialConfigurations,
      ...configurationSnippets.map((snippet: any) => snippet.body),
    ].filter((one) => one.request === "launch");
    assert.equal(offered.length, 6);
    assert.ok(offered.every((one) => one.stopOnEnd === true));
    const written: any = { type: "elitescript", request: "launch", name: "x", program: "/a.script" };
    assert.equal(configurations.resolveDebugConfiguration(undefined, written)?.["stopOnEnd"], undefined);
  });

  test("takes what a configuration leaves out from the settings", () => {
    Object.assign(fake.settings, { "elitescript.robot": "CS612", "elitescript.world": "cell.toml", "elitescript.strict": true });
    const given = { type: "elitescript", request: "launch", name: "x", program: "/a.script", robot: "CS66" };
    const resolved = new Configurations().resolveDebugConfigurationWithSubstitutedVariables(undefined, given);
    assert.deepEqual(resolved, { ...given, world: "cell.toml", strict: true });
    const journal = { type: "elitescript", request: "launch", name: "x", program: "/day.journal" };
    assert.deepEqual(new Configurations().resolveDebugConfigurationWithSubstitutedVariables(undefined, journal), journal);
    const attach = { type: "elitescript", request: "attach", name: "x", socket: "/s" };
    assert.deepEqual(new Configurations().resolveDebugConfigurationWithSubstitutedVariables(undefined, attach), attach);
  });

  test("begins from a code lens, which names the program by its URI", async () => {
    executable(".venv/bin/elitescript");
    await activate({ subscriptions: [] } as any);
    const uri = program();
    await command("elitescript.debug", uri.toString());
    assert.deepEqual((fake.debugged[0] as any).program, uri.fsPath);
  });
});

describe("going through a run", onPosix, () => {
  const asked: unknown[][] = [];

  beforeEach(async () => {
    executable(".venv/bin/elitescript");
    await activate({ subscriptions: [] } as any);
    asked.length = 0;
    const changes = [
      { old: "0", new: "1", t: 0.5, thread: "main", statement: 7, line: 3, cause: { statement: 6 } },
      { old: "1", new: "2", t: 1.5, thread: "main", statement: 17, line: 3, cause: { statement: 16 } },
    ];
    const customRequest = async (...words: unknown[]) => {
      asked.push(words);
      return { changes };
    };
    fake.session = { type: "elitescript", customRequest };
    const document = {
      uri: program(),
      languageId: "elitescript",
      getWordRangeAtPosition: () => new Range(1, 2, 1, 7),
      getText: () => "count",
    };
    fake.editor = { document, selection: { active: { line: 1, character: 3 } } };
  });

  test("to a time", async () => {
    fake.answer = "1.25";
    await command("elitescript.debug.runToTime");
    assert.deepEqual(asked, [["elitescript/goto", { t: 1.25 }]]);
    fake.answer = "soon";
    await command("elitescript.debug.runToTime");
    assert.equal(asked.length, 1);
  });

  test("to the statement that changed the word at the cursor last", async () => {
    await command("elitescript.debug.whoChanged");
    assert.deepEqual(asked, [
      ["elitescript/history", { name: "count", frameId: 4 }],
      ["elitescript/goto", { statement: 16 }],
    ]);
  });

  test("to the last time that the line of the cursor ran", async () => {
    await command("elitescript.debug.lastPass");
    const source = { path: (fake.editor as any).document.uri.fsPath };
    assert.deepEqual(asked, [["elitescript/lastPass", { source, line: 2 }]]);
  });

  test("needs a session, and shows what the adapter refuses", async () => {
    fake.session!.customRequest = async () => Promise.reject(new Error("line 2 has not run before"));
    await command("elitescript.debug.lastPass");
    fake.session = undefined;
    await command("elitescript.debug.lastPass");
    assert.deepEqual(fake.messages, ["line 2 has not run before", "Debug a program first (F5)."]);
  });
});

describe("running", onPosix, () => {
  test("saves the program and runs it as a task with the settings", async () => {
    const own = executable(".venv/bin/elitescript");
    fake.settings["elitescript.robot"] = "CS612";
    await activate({ subscriptions: [] } as any);
    const uri = program();
    let saves = 0;
    fake.documents = [{ uri, isDirty: true, languageId: "elitescript", save: async () => Boolean((saves += 1)) }];
    fake.active = fake.documents[0];
    await command("elitescript.run");
    const task = fake.tasks[0]!;
    assert.equal(saves, 1);
    assert.deepEqual(
      [task.execution.process, task.execution.args, task.execution.options, task.problemMatchers],
      [own, ["run", uri.fsPath, "--robot", "CS612"], { cwd: workspace }, "$elitescript"],
    );
  });

  test("asks for a program where there is none in a file", async () => {
    await activate({ subscriptions: [] } as any);
    fake.active = { uri: Uri.parse("untitled://1"), languageId: "elitescript" };
    await command("elitescript.run");
    assert.match(fake.messages.at(-1)!, /Open a program/);
    assert.deepEqual(fake.tasks, []);
  });

  test("tasks check each folder, and those of tasks.json are completed", async () => {
    const own = executable(".venv/bin/elitescript");
    const [check] = (await new Tasks().provideTasks()) as unknown as Task[];
    assert.deepEqual([check!.execution.process, check!.execution.args], [own, ["check", "."]]);
    const given = { definition: { type: "elitescript", command: "fmt", args: ["--check"] }, scope: fake.folders[0], name: "fmt" };
    const task = (await new Tasks().resolveTask(given as any)) as unknown as Task;
    assert.deepEqual(task.execution.args, ["fmt", ".", "--check"]);
  });

  test("the problem matcher reads what `elitescript check` prints", { skip: !process.env["ELITESCRIPT"] }, () => {
    writeFileSync(path.join(workspace, "b.script"), "def b():\n  movej(vv=1)\n  textmsg(lost)\nend\n");
    let printed = "";
    try {
      execFileSync(process.env["ELITESCRIPT"]!, ["check", "b.script"], { cwd: workspace, encoding: "utf8", stdio: "pipe" });
    } catch (error) {
      printed = (error as { stdout: string }).stdout;
    }
    const pattern = ABOUT.contributes.problemPatterns[0];
    const found = printed.split("\n").flatMap((line) => {
      const match = new RegExp(pattern.regexp).exec(line);
      return match ? [[pattern.file, pattern.line, pattern.severity, pattern.code].map((group) => match[group])] : [];
    });
    assert.deepEqual(found[0], ["b.script", "2", "error", "E303"]);
    assert.ok(found.some((one) => one[1] === "3" && one[2] === "warning"), printed);
  });
});

describe("the path page", onPosix, () => {
  const PLOT = 'echo "$@" >> "$(dirname "$0")/calls"; echo "<html>run $(wc -l < "$(dirname "$0")/calls")</html>" > "$4"';

  test("is what `elitescript plot` writes, beside the editor, new after each save", async () => {
    const own = executable(".venv/bin/elitescript", PLOT);
    fake.settings["elitescript.world"] = "cell.toml";
    const pages = new PathPages();
    const uri = program();
    await pages.show(uri);
    const panel = fake.panels[0]!;
    assert.equal(panel.webview.html.trim(), "<html>run 1</html>");
    await fake.onSaved.fire({ uri });
    await until(() => panel.webview.html.includes("run 2"));
    await fake.onSaved.fire({ uri: Uri.file("/other.script") });
    await pages.show(uri);
    assert.equal(fake.panels.length, 1);
    assert.equal(panel.webview.html.trim(), "<html>run 3</html>");
    assert.match(readFileSync(path.join(path.dirname(own), "calls"), "utf8"), /^plot \S+a\.script -o \S+page\.html --world cell\.toml --network none\n/);
    panel.dispose();
    await pages.show(uri);
    assert.equal(fake.panels.length, 2);
    pages.dispose();
    assert.equal(fake.panels[1]!.isOpen, false);
  });

  test("shows why there is none, and as text", async () => {
    executable(".venv/bin/elitescript", "echo 'error <b>' >&2; exit 3");
    const pages = new PathPages();
    await pages.show(program());
    assert.match(fake.panels[0]!.webview.html, /There is no page.*error &lt;b>/s);
    pages.dispose();
  });

  async function until(isTrue: () => boolean): Promise<void> {
    while (!isTrue()) {
      await new Promise((resolve) => setTimeout(resolve, 5));
    }
  }
});

describe("tests in the language", onPosix, () => {
  const COLLECTED = "test_a.py::test_python\ntest_cell.script::test_grip\nsub/test_b.script::test_x\n\n3 tests collected in 0.1s";
  const RAN = `
____________________ test_grip ____________________
test_cell.script:3: in test_grip
=========================== short test summary info ============================
PASSED sub/test_b.script::test_x
FAILED test_cell.script::test_grip - line 3: the gripper
ERROR test_c.script::test_y`;

  test("are the names in what pytest collects", () => {
    assert.deepEqual(namesIn(COLLECTED), ["test_cell.script::test_grip", "sub/test_b.script::test_x"]);
    assert.deepEqual(
      [...outcomesIn(RAN)].map(([name, outcome]) => `${outcome.word} ${name}`),
      ["PASSED sub/test_b.script::test_x", "FAILED test_cell.script::test_grip", "ERROR test_c.script::test_y"],
    );
  });

  test("are found and run by the Python beside elitescript", async () => {
    executable(".venv/bin/elitescript");
    const file = path.join(workspace, "answers");
    executable(".venv/bin/python", `echo "$@" >> ${file}\ncase "$*" in *--collect-only*) echo '${COLLECTED}' ;; *) echo '${RAN}' ;; esac`);
    mkdirSync(path.join(workspace, "sub"));
    writeFileSync(path.join(workspace, "test_cell.script"), "# cell\ndef test_grip():\n  assert True\nend\n");
    writeFileSync(path.join(workspace, "sub/test_b.script"), "def test_x():\n  assert True\nend\n");
    fake.files = [Uri.file(path.join(workspace, "test_cell.script"))];
    const tests = new ScriptTests();
    await tests.refresh();
    const controller = fake.controllers[0]!;
    const roots = [...controller.items].map(([, item]) => item);
    assert.deepEqual(roots.map((item) => item.label), ["test_cell.script", "sub/test_b.script"]);
    assert.equal([...roots[0]!.children][0]![1].range?.startLine, 1);
    const token = { onCancellationRequested: () => undefined };
    await controller.run({}, token);
    assert.deepEqual(fake.results, ["failed | test_grip | test_cell.script:3: in test_grip | line 2", "passed | test_x", "end"]);
    assert.match(readFileSync(file, "utf8"), / test_cell\.script::test_grip sub\/test_b\.script::test_x\n$/);
    tests.dispose();
  });

  test("say why they cannot be collected", async () => {
    executable(".venv/bin/elitescript");
    executable(".venv/bin/python", "echo 'No module named pytest' >&2; exit 1");
    fake.files = [program("test_a.script")];
    const tests = new ScriptTests();
    await tests.refresh();
    const [[, item]] = [...fake.controllers[0]!.items] as any;
    assert.deepEqual([item.label, item.error], ["pytest in cell", "No module named pytest\n"]);
    tests.dispose();
  });
});

describe("lines that are typed for the author", () => {
  const document: any = {};
  const cursor: any = { line: 1, character: 0 };
  const inserted: unknown[][] = [];

  beforeEach(() => {
    inserted.length = 0;
    fake.editor = { document, insertSnippet: async (...given: unknown[]) => inserted.push(given) };
  });

  test("leave the cursor in the body of the new block", async () => {
    const range = new Range(1, 0, 1, 0);
    assert.deepEqual(await keepCursor(document, cursor, [{ range, newText: "  \nend" }] as any), []);
    assert.deepEqual(inserted.map(([snippet, where]) => [(snippet as any).value, where]), [["  $0\nend", range]]);
  });

  test("are made by the editor where the cursor is not", async () => {
    for (const edits of [
      [],
      [{ range: new Range(1, 0, 1, 4), newText: "  " }],
      [{ range: new Range(2, 0, 2, 0), newText: "end\n" }],
      [{ range: new Range(1, 0, 1, 0), newText: "  " }, { range: new Range(2, 0, 2, 0), newText: "end\n" }],
    ]) {
      assert.deepEqual(await keepCursor(document, cursor, edits as any), edits);
    }
    assert.deepEqual(await keepCursor(document, cursor, null), []);
    assert.deepEqual(inserted, []);
  });
});

describe("package.json", () => {
  test("has the settings of the language server and the attributes of the debugger", () => {
    assert.deepEqual(
      Object.keys(ABOUT.contributes.configuration.properties).sort(),
      ["firmware", "hints.run", "network", "path", "robot", "strict", "trace.server", "world"].map((name) => `elitescript.${name}`),
    );
    const launch = Object.keys(ABOUT.contributes.debuggers[0].configurationAttributes.launch.properties);
    for (const name of ["program", "robot", "firmware", "world", "network", "set", "joints", "seed", "until", "stopOnEntry"]) {
      assert.ok(launch.includes(name), name);
    }
  });

  test("names files that are there", () => {
    const { languages, snippets, walkthroughs } = ABOUT.contributes;
    const named = [languages[0].configuration, snippets[0].path, ...walkthroughs[0].steps.map((step: any) => step.media.markdown)];
    for (const file of named) {
      assert.ok(readFileSync(path.join(HERE, file), "utf8").length > 0, file);
    }
  });
});

describe("the language configuration", () => {
  const rules = JSON.parse(readFileSync(path.join(HERE, "language-configuration.json"), "utf8"));
  const increase = new RegExp(rules.indentationRules.increaseIndentPattern);
  const decrease = new RegExp(rules.indentationRules.decreaseIndentPattern);

  test("indents below headers and goes back at `end` and clauses", () => {
    for (const line of ["def a():", "  if x == 1:  # c", "else:", "while True :", "sec s():"]) {
      assert.match(line, increase);
    }
    for (const line of ["x = {1: 2}", "define:", "if x: y()", "a[1:2]"]) {
      assert.doesNotMatch(line, increase);
    }
    for (const line of ["  end", "end;", "end # while", "  else:", "elif a:"]) {
      assert.match(line, decrease);
    }
    for (const line of ["endless()", "end = 3", "a = end"]) {
      assert.doesNotMatch(line, decrease);
    }
  });

  test("takes names in any script for words", () => {
    const words = new RegExp(rules.wordPattern.pattern, `${rules.wordPattern.flags}g`);
    assert.deepEqual("坐标_1.x = 2.5e-3 + größe".match(words), ["坐标_1", "x", "2.5e-3", "größe"]);
  });
});

describeGrammar(HERE);
