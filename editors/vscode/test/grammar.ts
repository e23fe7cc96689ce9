// The grammar in the engine of VS Code: vscode-textmate on vscode-oniguruma.

import assert from "node:assert/strict";
import { readdirSync, readFileSync } from "node:fs";
import * as path from "node:path";
import { before, describe, test } from "node:test";
import * as oniguruma from "vscode-oniguruma";
import * as textmate from "vscode-textmate";

export function describeGrammar(here: string): void {
  describe("the grammar", () => {
    let grammar: textmate.IGrammar;

    before(async () => {
      await oniguruma.loadWASM(readFileSync(path.join(here, "node_modules/vscode-oniguruma/release/onig.wasm")).buffer);
      const registry = new textmate.Registry({
        onigLib: Promise.resolve({
          createOnigScanner: (sources: string[]) => new oniguruma.OnigScanner(sources),
          createOnigString: (text: string) => new oniguruma.OnigString(text),
        }),
        loadGrammar: async () =>
          textmate.parseRawGrammar(readFileSync(path.join(here, "../textmate/elitescript.tmLanguage.json"), "utf8"), "g.json"),
      });
      grammar = (await registry.loadGrammar("source.elitescript"))!;
    });

    /** Each piece of a text with its innermost scope, without the name of the language. */
    function scopes(text: string): string[] {
      let state = textmate.INITIAL;
      const found: string[] = [];
      for (const line of text.split("\n")) {
        const read = grammar.tokenizeLine(line, state);
        state = read.ruleStack;
        for (const token of read.tokens) {
          const piece = line.slice(token.startIndex, token.endIndex).trim();
          const scope = token.scopes.at(-1)!.replace(/\.?elitescript$/, "");
          if (piece && scope !== "source") {
            found.push(`${piece} ${scope}`);
          }
        }
      }
      return found;
    }

    function has(text: string, ...wanted: string[]): void {
      const found = scopes(text);
      for (const one of wanted) {
        assert.ok(found.includes(one), `${one} is not in ${JSON.stringify(found)}`);
      }
    }

    test("definitions, `sec` and `end`", () => {
      has(
        "def job(a, b=1):\n  end\nend",
        "def storage.type.function", "job entity.name.function", "a variable.parameter.function", "b variable.parameter.function",
        "1 constant.numeric.integer", "end keyword.control.end",
      );
      has("sec watch():", "sec storage.type.function", "watch entity.name.function");
    });

    test("`end` as a name", () => {
      assert.ok(!scopes("end = min(a)").some((one) => one.includes("control.end")));
      assert.ok(!scopes("x = a[b:end]").some((one) => one.includes("control.end")));
    });

    test("commands, own functions, built-ins and attributes", () => {
      has("movej(q, a=1.4)", "movej support.function.command", "a variable.parameter.function-call", "1.4 constant.numeric.float");
      has("grip(len(x))", "grip entity.name.function.call", "len support.function.builtin");
      has("lock.movej()", "movej entity.name.function.member");
      has("except RuntimeError as e:", "except keyword.control.flow", "RuntimeError support.type.exception");
    });

    test("marks of the pendant", () => {
      has('  $ LINE: (12, "抓取")', "$ LINE keyword.control.directive.line-mark", "12 constant.numeric.integer", "抓取 string.quoted.double");
    });

    test("strings and comments", () => {
      has(String.raw`x = "a\n%d" # c`, String.raw`\n constant.character.escape`, "%d constant.other.placeholder", "# punctuation.definition.comment");
      has(`x = f"{len(y):>5}!"`, "len support.function.builtin", ":>5 constant.other.format-specification", "! string.interpolated.double");
      has("x = '''a\n# no comment\n'''\nend", "# no comment string.quoted.triple", "end keyword.control.end");
      has('x = "open\nend', "end keyword.control.end");
      has(String.raw`x = r"\d" + b'\x41'`, String.raw`\d string.quoted.raw.double`, String.raw`\x41 constant.character.escape`);
    });

    test("every line of the examples ends outside of strings and brackets where its program does", () => {
      const folder = path.join(here, "../../examples");
      for (const name of readdirSync(folder).filter((file) => file.endsWith(".script"))) {
        const found = scopes(readFileSync(path.join(folder, name), "utf8"));
        assert.equal(found.at(-1), "end keyword.control.end", name);
      }
    });
  });
}
