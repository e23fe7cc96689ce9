import assert from "node:assert/strict";
import { mock, test } from "node:test";
import { GUIDE_REPEAT_MS, nextStep, PendantModel, pointText, REPEAT_MS } from "../src/model/pendant.ts";
import { runState } from "../src/app/state.ts";
import { Studio } from "../src/model/studio.ts";
import type { ControllerState, FromSource, ToSource } from "../src/source/messages.ts";
import type { Listener, Source } from "../src/source/source.ts";
import { moment } from "./fake.ts";

class Controller implements Source {
  readonly sent: ToSource[] = [];
  listener!: Listener;
  start(listener: Listener): void {
    this.listener = listener;
    listener.linked("open");
  }
  send(message: ToSource): void {
    this.sent.push(message);
  }
  close(): void {}
}

const STATE: ControllerState = {
  link: "connected", address: "10.0.0.7:30001", model: "CS66", firmware: "2.14.0.0", serial: "1", robot_mode: "RUNNING",
  safety_mode: "NORMAL", task_state: "STOPPED", program: "", speed_fraction: 1,
};

function connected(abilities: Extract<FromSource, { type: "hello" }>["abilities"] = ["live", "control"]) {
  const source = new Controller();
  const studio = new Studio(source);
  studio.start();
  studio.message({ type: "hello", protocol: 1, product: "test", mode: "connected", abilities, title: "CS66 at 10.0.0.7" });
  source.sent.length = 0;
  return { source, studio, pendant: new PendantModel(studio) };
}

test("the state of the run says live only while there is a connection", () => {
  const { studio } = connected();
  const shown = (link: ControllerState["link"], t: number) => {
    studio.message({ type: "moment", moment: moment(t), controller: { ...STATE, link } });
    return [runState(studio).kind, runState(studio).text];
  };
  assert.deepEqual([runState(studio).kind, runState(studio).text], ["none", "connecting"]);
  assert.deepEqual(shown("connecting", 0), ["none", "connecting"]);
  assert.deepEqual(shown("connected", 1.5), ["good", "live, 1.5 s"]);
  assert.deepEqual(shown("lost", 1.5), ["error", "no connection since 1.5 s"]);
});

test("a button that is held repeats, and ends once", () => {
  mock.timers.enable({ apis: ["setInterval", "setTimeout"] });
  const { source, pendant } = connected();
  pendant.hold({ frame: "tool", axis: 2, direction: -1 });
  mock.timers.tick(3 * REPEAT_MS);
  pendant.speed.value = 1;
  mock.timers.tick(REPEAT_MS);
  pendant.release();
  pendant.release();
  mock.timers.tick(10 * REPEAT_MS);
  const jog = { type: "jog", frame: "tool", axis: 2, direction: -1, speed: 0.3 };
  assert.deepEqual(source.sent, [jog, jog, jog, jog, { ...jog, speed: 1 }, { type: "jog_end" }]);
  mock.timers.reset();
});

test("another axis ends the first", () => {
  mock.timers.enable({ apis: ["setInterval", "setTimeout"] });
  const { source, pendant } = connected();
  pendant.hold({ frame: "joint", axis: 0, direction: 1 });
  pendant.hold({ frame: "joint", axis: 1, direction: 1 });
  mock.timers.tick(REPEAT_MS);
  pendant.release();
  assert.deepEqual(source.sent.map((message) => (message.type === "jog" ? message.axis : message.type)), [0, "jog_end", 1, 1, "jog_end"]);
  mock.timers.reset();
});

test("a lost link ends it, and nothing goes on when it is back", () => {
  mock.timers.enable({ apis: ["setInterval", "setTimeout"] });
  const { source, studio, pendant } = connected();
  pendant.hold({ frame: "joint", axis: 0, direction: 1 });
  studio.linked("lost");
  mock.timers.tick(REPEAT_MS);
  studio.linked("open");
  const count = source.sent.length;
  mock.timers.tick(5 * REPEAT_MS);
  assert.equal(pendant.held.value, null);
  assert.equal(source.sent.length, count);
  mock.timers.reset();
});

test("without control nothing is sent", () => {
  const { source, pendant } = connected(["live"]);
  pendant.hold({ frame: "joint", axis: 0, direction: 1 });
  pendant.release();
  assert.deepEqual(source.sent, []);
});

test("a refusal is shown in its words", async () => {
  const { source, studio, pendant } = connected();
  const pressed = pendant.press("play");
  assert.equal(pendant.pressed.value, "play");
  const asked = source.sent[0]!;
  assert.ok(asked.type === "control");
  studio.message({ type: "refused", ask: asked.ask, text: "power on first" });
  assert.equal(await pressed, false);
  assert.equal(pendant.pressed.value, null);
  assert.deepEqual(studio.notices.value.map((notice) => [notice.severity, notice.text]), [["warning", "power on first"]]);
});

test("a taught point goes to the editor", () => {
  const { studio, pendant } = connected();
  const lines: string[] = [];
  studio.editor = { apply() {}, replace() {}, focus() {}, insert: (line: string) => lines.push(line) } as never;
  assert.equal(pendant.teach(), "");
  const moment = { t: 0, line: 0, joints: [0, -1.5707963, 1.2345678, -0.0000001, 3, 0.1], tcp_pose: [0, 0, 0, 0, 0, 0], globals: [], signals: {}, threads: [] } as const;
  studio.message({ type: "moment", moment, controller: STATE });
  pendant.teach();
  assert.deepEqual(lines, ["movej([0, -1.5708, 1.23457, 0, 3, 0.1])"]);
  assert.equal(pointText([1e-9, -1e-9, 0.000012, -3.14159265, 0, 0]), "movej([0, 0, 0.00001, -3.14159, 0, 0])");
});

test("hand guiding is repeated while it is on, and ends with its program", async () => {
  mock.timers.enable({ apis: ["setInterval"] });
  const { source, studio, pendant } = connected();
  const guided = pendant.guide(true);
  const asked = source.sent[0]!;
  assert.ok(asked.type === "control" && asked.action === "freedrive_on");
  studio.message({ type: "done", ask: asked.ask });
  await guided;
  source.sent.length = 0;
  mock.timers.tick(3 * GUIDE_REPEAT_MS);
  assert.deepEqual(source.sent, Array(3).fill({ type: "guiding" }));
  pendant.observe(STATE);
  assert.equal(pendant.isGuiding.value, true);
  pendant.observe({ ...STATE, task_state: "PLAYING" });
  assert.equal(pendant.isGuiding.value, true);
  pendant.observe(STATE);
  assert.equal(pendant.isGuiding.value, false);
  mock.timers.tick(3 * GUIDE_REPEAT_MS);
  assert.equal(source.sent.length, 3);
  mock.timers.reset();
});

test("the speed slider stays where it was put until the controller is there, or refuses", async () => {
  const { source, studio, pendant } = connected();
  pendant.chosenSpeed.value = 0.4;
  pendant.observe(STATE);
  assert.equal(pendant.chosenSpeed.value, 0.4);
  const set = pendant.setSpeed(0.3);
  pendant.observe({ ...STATE, speed_fraction: 0.3 });
  assert.equal(pendant.chosenSpeed.value, null);
  const again = pendant.setSpeed(0.2);
  for (const message of source.sent) studio.message({ type: "refused", ask: "ask" in message ? message.ask : 0, text: "no" });
  assert.deepEqual([await set, await again, pendant.chosenSpeed.value], [false, false, null]);
});

test("the next step to a moving arm", () => {
  assert.equal(nextStep(STATE), null);
  assert.equal(nextStep({ ...STATE, robot_mode: "POWER_OFF" }), "power_on");
  assert.equal(nextStep({ ...STATE, robot_mode: "IDLE" }), "release_brakes");
  assert.equal(nextStep({ ...STATE, safety_mode: "PROTECTIVE_STOP" }), "unlock");
  assert.equal(nextStep({ ...STATE, robot_mode: "POWER_OFF", safety_mode: "ROBOT_EMERGENCY_STOP" }), null);
  assert.equal(nextStep({ ...STATE, robot_mode: "POWER_OFF", link: "lost" }), null);
});
