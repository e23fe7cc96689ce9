// Ordinary sessions, driven by the client that the makers of VS Code test debug adapters with.
// ELITESCRIPT names the command; the programs are beside this file.
"use strict";

const assert = require("node:assert");
const path = require("node:path");
const { DebugClient } = require("@vscode/debugadapter-testsupport");

const FOLDER = process.env.PROGRAMS;
const CELL = path.join(FOLDER, "cell.script");
const ALARM = path.join(FOLDER, "alarm.script");

describe("elitescript dap", function () {
  this.timeout(20000);
  let client;

  beforeEach(() => {
    client = new DebugClient(process.env.ELITESCRIPT, "dap", "elitescript");
    client.defaultTimeout = 15000;
    return client.start();
  });

  afterEach(() => client.stop());

  it("answers an unknown request with an error and goes on", async () => {
    await client.initializeRequest();
    await assert.rejects(client.customRequest("illegalRequest"));
    await assert.rejects(client.customRequest("illegalAgain"));
  });

  it("names what it can do", async () => {
    const { body } = await client.initializeRequest();
    assert.equal(body.supportsStepBack, true);
    assert.equal(body.supportsConfigurationDoneRequest, true);
    assert.deepEqual(body.exceptionBreakpointFilters.map((one) => one.filter), ["alarm", "warning"]);
  });

  it("refuses another path format", async () => {
    await assert.rejects(
      client.initializeRequest({ adapterID: "x", linesStartAt1: true, columnsStartAt1: true, pathFormat: "url" }),
    );
  });

  it("runs a program to its end", async () => {
    const exited = client.waitForEvent("exited");
    await Promise.all([
      client.configurationSequence(),
      client.launch({ program: CELL, noDebug: true }),
      client.waitForEvent("terminated"),
    ]);
    assert.equal((await exited).body.exitCode, 0);
  });

  it("shows what the program says, with its place", async () => {
    await Promise.all([
      client.configurationSequence(),
      client.launch({ program: CELL }),
      client.assertOutput("stdout", "count 3"),
    ]);
  });

  it("stops on entry", async () => {
    await Promise.all([
      client.configurationSequence(),
      client.launch({ program: CELL, stopOnEntry: true }),
      client.assertStoppedLocation("entry", { path: CELL, line: 3 }),
    ]);
  });

  it("hits a breakpoint", () => client.hitBreakpoint({ program: CELL }, { path: CELL, line: 5 }));

  it("hits a conditional breakpoint", async () => {
    await Promise.all([
      client
        .waitForEvent("initialized")
        .then(() =>
          client.setBreakpointsRequest({ source: { path: CELL }, breakpoints: [{ line: 12, condition: "count == 2" }] }),
        )
        .then(() => client.configurationDoneRequest()),
      client.launch({ program: CELL }),
      client.assertStoppedLocation("breakpoint", { path: CELL, line: 12 }),
    ]);
    const found = await client.evaluateRequest({ expression: "count", context: "watch" });
    assert.equal(found.body.result, "2");
  });

  it("moves a breakpoint to a line with a statement", () =>
    client.hitBreakpoint({ program: CELL }, { path: CELL, line: 2 }, { path: CELL, line: 3 }, { path: CELL, line: 3 }));

  it("stops at an alarm before it unwinds", async () => {
    await Promise.all([
      client
        .waitForEvent("initialized")
        .then(() => client.setExceptionBreakpointsRequest({ filters: ["alarm"] }))
        .then(() => client.configurationDoneRequest()),
      client.launch({ program: ALARM }),
      client.assertStoppedLocation("exception", { path: ALARM, line: 3 }),
    ]);
    const found = await client.exceptionInfoRequest({ threadId: 1 });
    assert.match(found.body.description, /index/);
  });

  it("steps forward and back", async () => {
    await client.hitBreakpoint({ program: CELL }, { path: CELL, line: 10 });
    await Promise.all([client.nextRequest({ threadId: 1 }), client.assertStoppedLocation("step", { line: 11 })]);
    await Promise.all([client.stepInRequest({ threadId: 1 }), client.assertStoppedLocation("step", { line: 5 })]);
    await Promise.all([client.stepOutRequest({ threadId: 1 }), client.waitForEvent("stopped")]);
    await Promise.all([client.reverseContinueRequest({ threadId: 1 }), client.assertStoppedLocation("breakpoint", { line: 10 })]);
    await Promise.all([client.stepBackRequest({ threadId: 1 }), client.assertStoppedLocation("step", { line: 9 })]);
  });

  it("lets variables be looked at and set", async () => {
    await client.hitBreakpoint({ program: CELL }, { path: CELL, line: 12 });
    const frame = (await client.stackTraceRequest({ threadId: 1 })).body.stackFrames[0].id;
    const { scopes } = (await client.scopesRequest({ frameId: frame })).body;
    assert.deepEqual(scopes.map((one) => one.name), ["Locals", "Globals", "Robot"]);
    const globals = scopes[1].variablesReference;
    const { variables } = (await client.variablesRequest({ variablesReference: globals })).body;
    assert.equal(variables.find((one) => one.name === "count").value, "0");
    await client.setVariableRequest({ variablesReference: globals, name: "count", value: "2" });
    const exited = client.waitForEvent("exited");
    await client.setBreakpointsRequest({ source: { path: CELL }, breakpoints: [] });
    await Promise.all([client.continueRequest({ threadId: 1 }), client.assertOutput("stdout", "count 3")]);
    assert.equal((await exited).body.exitCode, 0);
  });

  it("refuses a program that does not compile, with the place", async () => {
    const broken = path.join(FOLDER, "broken.script");
    require("node:fs").writeFileSync(broken, "def cell():\n  x = = 1\nend\n");
    try {
      await client.initializeRequest();
      await assert.rejects(client.launchRequest({ program: broken }), /line 2/);
    } finally {
      require("node:fs").unlinkSync(broken);
    }
  });
});
