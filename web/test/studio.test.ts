import assert from "node:assert/strict";
import { afterEach, beforeEach, mock, test } from "node:test";
import { ANSWER_MS } from "../src/model/requests.ts";
import { EDIT_MS, STALE_MS, type Studio } from "../src/model/studio.ts";
import { TELL_MS } from "../src/model/settings.ts";
import { browserLanguage, chosenLanguage, language } from "../src/text/language.ts";
import { began, ended, FILE, HELLO, moment, opened, rows, settled, type FakeSource } from "./fake.ts";

beforeEach(() => mock.timers.enable({ apis: ["setTimeout"] }));
afterEach(() => mock.timers.reset());

/** A page whose first run has ended at 2 s. */
function ran(): { source: FakeSource; studio: Studio } {
  const page = opened();
  page.source.say(began(1, page.studio.version.value));
  page.source.rows(rows(1, [0, 250, 500]));
  page.source.say(ended(1, 2));
  return page;
}

// ---------------------------------------------------------------- the text

test("the file's text is told at once, and each edit after a pause too", () => {
  const { source, studio } = opened();
  assert.deepEqual(source.all("program").map((message) => message.text), [FILE.text]);
  mock.timers.tick(EDIT_MS);
  studio.edit("a");
  assert.equal(source.all("program").length, 2);
});

test("while keys come fast the newest text alone is told, and it is told", () => {
  const { source, studio } = opened();
  for (const text of ["a", "ab", "abc"]) studio.edit(text);
  assert.equal(source.all("program").length, 1);
  mock.timers.tick(EDIT_MS);
  assert.deepEqual(source.all("program").map((message) => message.text), [FILE.text, "abc"]);
  mock.timers.tick(10 * EDIT_MS);
  assert.equal(source.all("program").length, 2);
});

test("a service is asked about a text that was told", async () => {
  const { source, studio } = opened();
  studio.edit("new");
  void studio.ask("hover", { line: 1, column: 1 });
  const [program, service] = source.sent.slice(-2);
  assert.equal(program?.type === "program" && program.text, "new");
  assert.equal(service?.type === "service" && service.version, studio.version.value);
});

test("problems of an older text are dropped", () => {
  const { source, studio } = opened();
  source.say({ type: "problems", version: studio.version.value, list: [], compiles: true });
  const kept = studio.problems.value;
  studio.edit("new");
  source.say({ type: "problems", version: studio.version.value - 1, list: [], compiles: false });
  assert.equal(studio.problems.value, kept);
});

// ---------------------------------------------------------------- runs

test("what is not of the newest run is dropped", () => {
  const { source, studio } = ran();
  source.say(began(2, 2));
  source.say({ type: "progress", run: 1, t: 50 });
  source.rows(rows(1, [5000]));
  assert.equal(studio.run.value?.known_s, 0);
  assert.equal(studio.run.value?.samples.length, 0);
});

test("the run before stays while the newest is not that far, and one that was replaced early does not take its place", () => {
  const { source, studio } = ran();
  const first = studio.run.value;
  source.say(began(2, 2), { type: "progress", run: 2, t: 0.5 }, began(3, 3));
  assert.equal(studio.before.value, first);
  source.say({ type: "progress", run: 3, t: 1 });
  assert.equal(studio.end.value, 2);
  assert.equal(studio.runAt(0.5)?.number, 3);
  assert.equal(studio.runAt(1.5)?.number, 1);
  source.say(ended(3, 1.25));
  assert.equal(studio.end.value, 1.25);
  assert.equal(studio.runAt(1.5)?.number, 3);
});

test("up to the first change a run takes over rows; all else comes again, with the lines of its text", () => {
  const { source, studio } = opened();
  source.say(began(1, 1));
  source.rows(rows(1, [0, 250, 500]));
  source.say(
    { type: "lines", run: 1, thread: "main", t: [0, 1], line: [1, 2] },
    { type: "events", run: 1, list: [{ type: "print", t: 0.5, text: "a", line: 1 }] },
    ended(1, 2),
    began(2, 2, 1.2),
  );
  assert.equal(studio.run.value!.known_s, 1.2);
  source.rows(rows(2, [300, 400], 1000));
  source.say(
    { type: "lines", run: 2, thread: "main", t: [0, 1.5], line: [2, 4] },
    { type: "moves", run: 2, list: [{ start_s: 1, end_s: 1.6, kind: "movel", line: 2 }] },
    { type: "events", run: 2, list: [{ type: "print", t: 0.5, text: "a", line: 2 }] },
  );
  const run = studio.run.value!;
  assert.deepEqual([...run.samples.t], [0, 1, 1.2, 1.6]);
  assert.deepEqual([...run.samples.column("q1")], [0, 250, 1300, 1400]);
  assert.deepEqual([0.5, 1.55].map((t) => run.lineAt(t)), [2, 4]);
  assert.deepEqual(run.messages.map((event) => event.line), [2]);
});

test("what comes again for a time counts instead of what was known", () => {
  const { source, studio } = opened();
  source.say(began(1, 1), { type: "lines", run: 1, thread: "main", t: [0, 1, 1.5], line: [1, 2, 3] }, { type: "lines", run: 1, thread: "main", t: [1, 2], line: [7, 8] });
  const run = studio.run.value!;
  assert.deepEqual([0.5, 1.2, 1.7, 2.5].map((t) => run.lineAt(t)), [1, 7, 7, 8]);
});

test("a text that does not compile leaves the last good run, which is stale from the edited line on", () => {
  const { source, studio } = ran();
  assert.equal(studio.staleFrom.value, 0);
  studio.edit("one\ntwo(\nthree");
  assert.equal(studio.staleFrom.value, 0);
  source.say({ type: "problems", version: studio.version.value, list: [], compiles: false });
  assert.equal(studio.run.value?.number, 1);
  assert.equal(studio.staleFrom.value, 2);
  studio.edit(FILE.text);
  assert.equal(studio.staleFrom.value, 0);
});

test("a run that does not come makes the one on the screen stale", () => {
  const { source, studio } = ran();
  studio.edit("changed");
  mock.timers.tick(STALE_MS);
  assert.equal(studio.staleFrom.value, 1);
  source.say(began(2, studio.version.value));
  assert.equal(studio.staleFrom.value, 0);
});

// ---------------------------------------------------------------- time

test("one question for a state at a time, then the newest; the answer is exact", async () => {
  const { source, studio } = ran();
  await settled();
  source.sent.length = 0;
  const first = studio.isExact.value; // nothing at 0 s yet: it was asked when the run was there
  for (const t of [0.4, 0.8, 1.2]) studio.setCursor(t);
  const open = source.all("seek");
  assert.ok(!first && open.length <= 1);
  // The answer to the first question is of another time than the cursor: shown, but not exact.
  source.say({ type: "state", ask: 1, run: 1, moment: moment(0) });
  await settled();
  const asked = source.last("seek");
  assert.equal(asked.t, 1.2);
  assert.equal(studio.isExact.value, false);
  source.say({ type: "state", ask: asked.ask, run: 1, moment: moment(1.2) });
  await settled();
  assert.equal(studio.isExact.value, true);
  assert.equal(source.all("seek").length, 1);
});

test("times are ticks", () => {
  const { studio } = ran();
  studio.setCursor(1.2345);
  assert.equal(studio.cursor.value, 1.236);
  studio.setCursor(-3);
  assert.equal(studio.cursor.value, 0);
});

test("the end is exact without a question, and stays the end of a run that is shorter", () => {
  const { source, studio } = ran();
  studio.setCursor(99);
  assert.equal(studio.cursor.value, 2);
  assert.equal(studio.isExact.value, true);
  source.say(began(2, 2), ended(2, 1.5));
  assert.equal(studio.cursor.value, 1.5);
  source.say(began(3, 3), ended(3, 3));
  assert.equal(studio.cursor.value, 3);
});

test("a cursor that a shorter run has moved comes back with a longer one", () => {
  const { source, studio } = ran();
  studio.setCursor(1.8);
  source.say(began(2, 2), ended(2, 1));
  assert.equal(studio.cursor.value, 1);
  source.say(began(3, 3), ended(3, 5));
  assert.equal(studio.cursor.value, 1.8);
});

test("a time that is not computed yet is asked for when it is", async () => {
  const { source, studio } = ran();
  source.say({ type: "state", ask: 1, run: 1, moment: moment(0) });
  await settled();
  studio.setCursor(1.2);
  source.say({ type: "state", ask: source.last("seek").ask, run: 1, moment: moment(1.2) });
  await settled();
  source.sent.length = 0;
  source.say(began(2, 2), { type: "progress", run: 2, t: 1 });
  assert.equal(source.all("seek").length, 0);
  source.say({ type: "progress", run: 2, t: 1.3 });
  assert.deepEqual(source.all("seek").map((seek) => [seek.run, seek.t]), [[2, 1.2]]);
});

test("steps follow one another by the position of the last state", async () => {
  const { source, studio } = ran();
  source.say({ type: "state", ask: 1, run: 1, moment: moment(0) });
  await settled();
  void studio.step(1);
  void studio.step(1);
  await settled();
  assert.equal(source.all("step").length, 1);
  source.say({ type: "state", ask: source.last("step").ask, run: 1, moment: moment(0.5, 2, "p1") });
  await settled();
  assert.equal(source.all("step").length, 2);
  assert.equal(source.last("step").position, "p1");
  source.say({ type: "state", ask: source.last("step").ask, run: 1, moment: moment(0.5, 3, "p2") });
  await settled();
  assert.equal(studio.cursor.value, 0.5);
  assert.equal(studio.moment.value?.line, 3);
  assert.equal(source.all("step").length, 2);
});

test("run plays from the start at the end; stop ends computation and goes to 0", () => {
  const { source, studio } = ran();
  studio.setCursor(2);
  studio.play();
  assert.equal(studio.cursor.value, 0);
  assert.equal(studio.isPlaying.value, true);
  studio.setCursor(1);
  studio.stopAll();
  assert.equal(studio.isPlaying.value, false);
  assert.equal(studio.cursor.value, 0);
  assert.equal(source.all("stop").length, 1);
});

test("a click on a line goes from visit to visit", () => {
  const { source, studio } = ran();
  source.say({ type: "lines", run: 1, thread: "main", t: [0, 0.4, 0.8, 1.2], line: [1, 2, 1, 2] });
  const seen = [];
  for (let click = 0; click < 3; click++) {
    studio.visit(2);
    seen.push(studio.cursor.value);
  }
  assert.deepEqual(seen, [0.4, 1.2, 0.4]);
});

test("events beside a time", () => {
  const { source, studio } = ran();
  source.say({ type: "events", run: 1, list: [{ type: "print", t: 0.4 }, { type: "print", t: 1.6 }] });
  studio.setCursor(1);
  studio.jumpToEvent(1);
  assert.equal(studio.cursor.value, 1.6);
  studio.jumpToEvent(1);
  assert.equal(studio.cursor.value, 1.6);
  studio.jumpToEvent(-1);
  assert.equal(studio.cursor.value, 0.4);
});

// ---------------------------------------------------------------- options and inputs

test("options and inputs can be undone; a slider's values are one step", () => {
  const { source, studio } = opened();
  studio.setOptions({ robot: "cs63" });
  for (const value of [1, 2, 3]) studio.setInput("standard_analog_in[0]", value, 0.5);
  mock.timers.tick(EDIT_MS);
  assert.deepEqual(source.last("program").options, { robot: "cs63", inputs: [{ name: "standard_analog_in[0]", value: 3, at_s: 0.5 }] });
  studio.undo();
  mock.timers.tick(EDIT_MS);
  assert.deepEqual(source.last("program").options, { robot: "cs63" });
  studio.undo();
  studio.undo();
  assert.deepEqual(studio.options.value, {});
  studio.redo();
  studio.redo();
  assert.equal(studio.options.value.inputs?.[0]?.value, 3);
  studio.removeInput(0);
  assert.equal(studio.options.value.inputs, undefined);
});

test("inputs are in the order of time, one for each signal and time", () => {
  const { studio } = opened();
  studio.setInput("b", true, 2);
  studio.setInput("a", true, 1);
  studio.setInput("b", false, 2);
  assert.deepEqual(studio.options.value.inputs, [{ name: "a", value: true, at_s: 1 }, { name: "b", value: false, at_s: 2 }]);
});

test("a run at its limit goes on", () => {
  const { source, studio } = opened();
  source.say(began(1, 1), { type: "run_ended", run: 1, state: "time_limit", moment: moment(120) });
  studio.goOn();
  assert.deepEqual(source.last("go_on"), { type: "go_on", run: 1, until_s: 240 });
  assert.equal(studio.run.value?.ended, null);
});

// ---------------------------------------------------------------- files

test("save writes the text, which is then that of the file", async () => {
  const { source, studio } = opened();
  studio.edit("mine");
  assert.equal(studio.isModified.value, true);
  const saving = studio.save();
  assert.deepEqual(source.last("save"), { type: "save", ask: source.last("save").ask, text: "mine", seen: "d1" });
  studio.edit("mine and more");
  source.say({ type: "saved", ask: source.last("save").ask, digest: "d2" });
  assert.equal(await saving, true);
  assert.equal(studio.file.value?.digest, "d2");
  assert.equal(studio.isModified.value, true);
  studio.edit("mine");
  assert.equal(studio.isModified.value, false);
});

test("a save that meets another text shows both; the choice decides what the next one writes over", async () => {
  const { source, studio } = opened();
  studio.edit("mine");
  const saving = studio.save();
  source.say({ type: "refused", ask: source.last("save").ask, text: "changed", conflict: { text: "theirs", digest: "d9" } });
  assert.equal(await saving, false);
  assert.deepEqual(studio.conflict.value, { why: "save", theirs: "theirs", digest: "d9" });
  assert.equal(studio.text.value, "mine");
  studio.keepMine();
  assert.equal(studio.conflict.value, null);
  void studio.save();
  assert.equal(source.last("save").seen, "d9");
});

test("a save that fails says why and keeps the text", async () => {
  const { source, studio } = opened();
  studio.edit("mine");
  const saving = studio.save();
  source.say({ type: "refused", ask: source.last("save").ask, text: "no space left on device" });
  assert.equal(await saving, false);
  assert.match(studio.notices.value[0]!.text, /no space left/);
  assert.equal(studio.isModified.value, true);
  assert.equal(studio.isSaving.value, false);
});

test("a file that changes is read again if nothing was edited, else both texts are shown", () => {
  const { source, studio } = opened();
  source.say({ type: "file_changed", name: "a.script", text: "theirs", digest: "d2" });
  assert.equal(studio.text.value, "theirs");
  assert.equal(studio.isModified.value, false);
  studio.edit("mine");
  source.say({ type: "file_changed", name: "a.script", text: "theirs again", digest: "d3" });
  assert.equal(studio.text.value, "mine");
  assert.equal(studio.conflict.value?.theirs, "theirs again");
  studio.takeTheirs();
  assert.equal(studio.text.value, "theirs again");
  assert.equal(studio.isModified.value, false);
  assert.equal(studio.conflict.value, null);
});

test("a file that is gone is not saved", () => {
  const { source, studio } = opened();
  source.say({ type: "file_changed", name: "a.script", digest: "" });
  assert.equal(studio.text.value, FILE.text);
  assert.equal(studio.isModified.value, true);
});

test("a draft is shown, with a conflict where the file has changed since", () => {
  const { source, studio } = opened();
  source.say({ ...FILE, name: "b.script", draft: { text: "draft", seen: "d1", at: "12:00" } });
  assert.equal(studio.text.value, "draft");
  assert.equal(studio.draftAt.value, "12:00");
  assert.equal(studio.conflict.value, null);
  studio.takeTheirs();
  assert.equal(studio.text.value, FILE.text);
  assert.equal(studio.draftAt.value, null);
  source.say({ ...FILE, name: "c.script", draft: { text: "draft", seen: "older", at: "12:00" } });
  assert.deepEqual(studio.conflict.value, { why: "draft", theirs: FILE.text, digest: "d1" });
});

test("another file begins without runs", () => {
  const { source, studio } = ran();
  studio.setCursor(1);
  source.say({ ...FILE, name: "b.script", text: "other" });
  assert.equal(studio.run.value, null);
  assert.equal(studio.cursor.value, 0);
  assert.equal(studio.text.value, "other");
});

// ---------------------------------------------------------------- the link

test("after a lost link the text of the page is told again, and kept", () => {
  const { source, studio } = opened();
  studio.edit("typed while it was lost");
  source.link("lost");
  source.link("open");
  source.sent.length = 0;
  source.say(HELLO, { ...FILE, draft: { text: "older", seen: "d1", at: "12:00" } });
  assert.equal(source.last("program").text, "typed while it was lost");
  assert.equal(studio.text.value, "typed while it was lost");
});

test("after a lost link the file of the page is opened again before its text is told", () => {
  const { source, studio } = opened();
  source.link("lost");
  studio.edit("typed while it was lost");
  source.link("open");
  source.sent.length = 0;
  // The source begins with the first program of the folder, whose draft this text is not.
  source.say(HELLO, { ...FILE, name: "first.script", text: "other" });
  mock.timers.tick(5 * EDIT_MS);
  assert.deepEqual(source.all("program"), []);
  assert.equal(source.last("open").name, FILE.name);
  source.say(FILE);
  assert.equal(source.last("program").text, "typed while it was lost");
  assert.equal(studio.text.value, "typed while it was lost");
});

test("what was chosen for a run is not taken to another file", () => {
  const { source, studio } = opened();
  studio.setOptions({ robot: "cs612", seed: 3 });
  void studio.open("b.script");
  source.say({ ...FILE, name: "b.script", text: "b" });
  mock.timers.tick(EDIT_MS);
  assert.deepEqual(source.last("program").options, {});
  assert.equal(source.last("program").text, "b");
  assert.equal(studio.canUndo.value, false);
});

test("a file that has changed while the link was lost is a conflict", () => {
  const { source, studio } = opened();
  studio.edit("mine");
  source.link("lost");
  source.link("open");
  source.say(HELLO, { ...FILE, text: "theirs", digest: "d7" });
  assert.equal(studio.text.value, "mine");
  assert.equal(studio.conflict.value?.digest, "d7");
});

test("requests fail with a lost link, and when no answer comes", async () => {
  const { source, studio } = opened();
  const lost = assert.rejects(studio.ask("hover"), /lost/);
  source.link("lost");
  await lost;
  source.link("open");
  const late = assert.rejects(studio.ask("hover"), /No answer in 20 s/);
  mock.timers.tick(ANSWER_MS);
  await late;
});

test("a state is asked for again after a lost link", async () => {
  const { source, studio } = ran();
  source.link("lost");
  await settled();
  source.link("open");
  source.say(HELLO, FILE, began(2, studio.version.value), ended(2, 2));
  assert.equal(source.last("seek").run, 2);
});

test("a run that is replaced while its states are asked for is not mentioned, and the new one is asked", async () => {
  const { source, studio } = ran();
  await settled();
  studio.setCursor(0.4);
  const stepping = studio.step(1);
  const [sought, step] = [source.last("seek").ask, source.last("step").ask];
  source.say(began(2, studio.version.value));
  for (const ask of [sought, step]) source.say({ type: "refused", ask, text: "this run is not shown any more" });
  source.say(ended(2, 2));
  await stepping;
  await settled();
  assert.deepEqual(studio.notices.value, []);
  assert.deepEqual([source.last("seek").run, source.last("seek").t], [2, 0.4]);
});

test("refusals are answers where something was asked, else notices", async () => {
  const { source, studio } = opened();
  const asked = assert.rejects(studio.ask("hover"), /not now/);
  source.say({ type: "refused", ask: source.last("service").ask, text: "not now" });
  await asked;
  source.say({ type: "refused", text: "no such message" });
  assert.deepEqual(studio.notices.value.map((notice) => notice.text), ["no such message"]);
  studio.dismiss(studio.notices.value[0]!.id);
  assert.equal(studio.notices.value.length, 0);
});

// ---------------------------------------------------------------- settings, controllers

test("the language of the browser is not remembered, one that was chosen is", () => {
  const { source, studio } = opened();
  browserLanguage.value = "zh";
  studio.settings.sizes.value = { left: 0.5 };
  mock.timers.tick(TELL_MS);
  assert.equal(language.value, "zh");
  assert.equal("language" in source.last("settings").values, false);
  chosenLanguage.value = "en";
  mock.timers.tick(TELL_MS);
  assert.equal(source.last("settings").values["language"], "en");
  assert.equal(language.value, "en");
  browserLanguage.value = "en";
  chosenLanguage.value = null;
});

test("settings are taken from the source, checked, and told when they change", () => {
  const { source, studio } = opened();
  source.say({ ...HELLO, settings: { angle: "rad", length: "miles", sizes: { left: 0.4, right: 7, time: "x" }, open: { "wide.cycle": false } } });
  assert.deepEqual(studio.display.value, { angle: "rad", length: "mm" });
  assert.deepEqual(studio.settings.sizes.value, { left: 0.4 });
  mock.timers.tick(TELL_MS);
  assert.equal(source.all("settings").length, 0);
  studio.settings.sizes.value = { left: 0.5 };
  studio.settings.sizes.value = { left: 0.6 };
  mock.timers.tick(TELL_MS);
  assert.deepEqual(source.all("settings").map((message) => message.values["sizes"]), [{ left: 0.6 }]);
});

test("with a controller the cursor goes with its time, until it is held", () => {
  const { source, studio } = opened();
  const controller = {
    link: "connected", address: "10.0.0.2", model: "CS66", firmware: "", serial: "", robot_mode: "", safety_mode: "", task_state: "", program: "", speed_fraction: 1,
  } as const;
  source.say({ ...HELLO, mode: "connected", abilities: ["live"] });
  source.say({ type: "moment", moment: moment(10), controller });
  assert.equal(studio.cursor.value, 10);
  studio.pause();
  source.say({ type: "moment", moment: moment(11), controller });
  assert.equal(studio.cursor.value, 10);
  studio.play();
  source.say({ type: "moment", moment: moment(12), controller });
  assert.equal(studio.cursor.value, 12);
  assert.equal(studio.isPlaying.value, false);
  assert.equal(studio.robot.value, "CS66 · 10.0.0.2");
  studio.linked("lost");
  assert.equal(studio.controller.value?.link, "lost");
});

// ---------------------------------------------------------------- messages that cross

test("a run that begins after a further edit has the text that was told for it", () => {
  const { source, studio } = ran();
  mock.timers.tick(EDIT_MS);
  studio.edit("first\ntwo\nthree");
  const { version } = studio;
  const told = version.value;
  studio.edit("first\ntwo\nthree\nfour");
  source.say(began(2, told));
  assert.equal(studio.run.value?.text, "first\ntwo\nthree");
  mock.timers.tick(STALE_MS);
  assert.equal(studio.staleFrom.value, 4);
  source.say(began(3, version.value));
  assert.equal(studio.staleFrom.value, 0);
});

test("a run of an older text that begins late does not hide that the newest has none", () => {
  const { source, studio } = ran();
  mock.timers.tick(EDIT_MS);
  studio.edit("a");
  const told = studio.version.value;
  studio.edit("ab");
  mock.timers.tick(STALE_MS);
  source.say(began(2, told));
  assert.equal(studio.staleFrom.value, 1);
});

test("what is asked while the link is lost fails at once, and Save is free again", async () => {
  const { source, studio } = opened();
  source.link("lost");
  studio.edit("new");
  assert.equal(await studio.save(), false);
  assert.equal(studio.isSaving.value, false);
  assert.equal(source.all("save").length, 0);
  source.link("open");
  void studio.save();
  assert.equal(source.all("save").length, 1);
});

test("a message of a kind or a run that is not known changes nothing", () => {
  const { source, studio } = opened();
  source.say({ type: "progress", run: 7, t: 1 }, { type: "unheard_of" } as never);
  assert.equal(studio.run.value, null);
});

test("the time of a controller that begins anew is its own", () => {
  const { source, studio } = opened();
  source.say({ ...HELLO, mode: "connected", abilities: ["live"] }, began(1, 0));
  source.rows(rows(1, [900_000]));
  source.say(began(2, 0));
  source.rows(rows(2, [250]));
  assert.equal(studio.end.value, 1);
  assert.equal(studio.runAt(2)?.number, 2);
});

test("the fix of a finding is made in the text that was checked, or not at all", () => {
  const { studio } = opened();
  const made: unknown[] = [];
  studio.editor = { apply: (edits) => made.push(edits), replace() {}, insert() {}, focus() {} };
  const edits = [{ line: 1, column: 1, end_line: 1, end_column: 2, text: "x" }];
  const { value } = studio.version;
  studio.fix(value, edits);
  studio.edit("new");
  studio.fix(value, edits);
  assert.deepEqual(made, [edits]);
});

test("a place in the run is sent with the version of its text", () => {
  const { studio } = ran();
  const { value } = studio.version;
  studio.edit("zero\none\ntwo\nthree");
  studio.jump(1, { line: 2, column: 1 });
  assert.deepEqual(studio.goto.value, { line: 2, column: 1, version: value });
});

test("Run computes again what Stop has ended, once", () => {
  const { source, studio } = ran();
  source.say(began(2, studio.version.value));
  studio.stopAll();
  source.say({ ...ended(2, 1), state: "stopped" } as never);
  mock.timers.tick(EDIT_MS);
  const told = source.all("program").length;
  studio.play();
  studio.play();
  assert.equal(source.all("program").length, told + 1);
});
