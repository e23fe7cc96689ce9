import assert from "node:assert/strict";
import { test } from "node:test";
import { chosenLanguage } from "../src/text/language.ts";
import { SAID, said } from "../src/text/said.ts";

test("in English what a source says stays as it is", () => {
  chosenLanguage.value = "en";
  for (const [english] of SAID) assert.equal(said(english), english);
});

test("in Chinese each row is its own, with its values", () => {
  chosenLanguage.value = "zh";
  for (const [english, chinese] of SAID) {
    const value = (place: string) => `v${place}`;
    assert.equal(said(english.replace(/\{(\d)\}/g, (_, place: string) => value(place))), chinese.replace(/\{(\d)\}/g, (_, place: string) => value(place)), english);
  }
});

test("waits are put together of their parts, and names of programs stay", () => {
  chosenLanguage.value = "zh";
  assert.equal(said("the end of its move, until 3.500 s"), "其运动结束，直到 3.500 s");
  assert.equal(said("lock pallet, held by main"), "锁 pallet，由 main 持有");
  assert.equal(said("data on socket 'the end of its move'"), "套接字 'the end of its move' 上的数据");
  assert.equal(said("CS66: RTSI port 1.2.3.4:30004: a message says that it has 0 bytes; the shortest has 3"), "CS66：RTSI 端口 1.2.3.4:30004：消息声称有 0 字节；最短的有 3");
  assert.equal(said("CS66 at 1.2.3.4:30001: primary port 1.2.3.4:30001: nothing answers within 3 s"), "CS66 at 1.2.3.4:30001：主端口 1.2.3.4:30001：3 s 内无应答");
});

test("words of programs are no words of ours, and long ones cost nothing", () => {
  chosenLanguage.value = "zh";
  for (const words of ["", "hello", "the end", "上电", "x".repeat(1e6), `${"a: ".repeat(600)}b`]) assert.equal(said(words), words);
});
