import assert from "node:assert/strict";
import { mock, test } from "node:test";
import { BURST_MS, LONGEST_MS, QUIET_MS, RestingFrames, Typing } from "../src/model/redraws.ts";

test("one key delays no picture; while keys come it waits for quiet, but not for ever", () => {
  const typing = new Typing();
  assert.equal(typing.wait(0, 0), 0);
  typing.key(1000);
  assert.equal(typing.wait(1010, 1010), 0);
  typing.key(1000 + BURST_MS - 1);
  const now = 1000 + BURST_MS;
  assert.equal(typing.wait(now, now), QUIET_MS - 1);
  assert.equal(typing.wait(now, now - LONGEST_MS + 5), 5);
  assert.equal(typing.wait(now + QUIET_MS, now), 0);
});

test("a picture that waits is drawn once after the last key, or not at all if it is cancelled", () => {
  mock.timers.enable({ apis: ["setTimeout", "Date"] });
  try {
    const typing = new Typing();
    const frames = new RestingFrames(typing, { request: (frame) => (frame(0), 0), cancel: () => undefined }, () => Date.now());
    typing.key(Date.now());
    typing.key(Date.now());
    let drawn = 0;
    frames.request(() => drawn++);
    frames.cancel(frames.request(() => assert.fail("it was cancelled")));
    mock.timers.tick(QUIET_MS - 10);
    typing.key(Date.now());
    mock.timers.tick(QUIET_MS - 10);
    assert.equal(drawn, 0);
    mock.timers.tick(10);
    assert.equal(drawn, 1);
  } finally {
    mock.timers.reset();
  }
});
