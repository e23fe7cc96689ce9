/** Shows the Markdown that the language services write, as nodes: headings, lists, tables, code, bold, links to places on the page. */

/** Returns the nodes of a text. Nothing in it can become markup of another kind, and no address is ever loaded. */
export function markdownNodes(markdown: string): DocumentFragment {
  const made = document.createDocumentFragment();
  const lines = markdown.split("\n");
  let at = 0;
  while (at < lines.length) {
    const line = lines[at]!;
    const fence = /^\s*(```+|~~~+)/.exec(line);
    if (fence) {
      const end = lines.findIndex((other, index) => index > at && other.trimStart().startsWith(fence[1]!));
      const body = lines.slice(at + 1, end < 0 ? undefined : end);
      element(made, "pre").appendChild(text("code", body.join("\n")));
      at = end < 0 ? lines.length : end + 1;
    } else if (/^\s*\|/.test(line)) {
      const rows = taken(lines, at, (other) => /^\s*\|/.test(other));
      table(element(made, "table"), rows);
      at += rows.length;
    } else if (/^\s*[-*] /.test(line)) {
      const rows = taken(lines, at, (other) => /^\s*[-*] /.test(other) || /^\s{2,}\S/.test(other));
      const list = element(made, "ul");
      for (const row of rows) inline(element(list, "li"), row.replace(/^\s*[-*] /, ""));
      at += rows.length;
    } else if (/^#+ /.test(line)) {
      inline(element(made, "h4"), line.replace(/^#+ /, ""));
      at++;
    } else if (/^\s*(---+|\*\*\*+)\s*$/.test(line)) {
      element(made, "hr");
      at++;
    } else if (line.trim() === "") {
      at++;
    } else {
      const rows = taken(lines, at, (other) => other.trim() !== "" && !/^\s*(```|~~~|\||[-*] |#+ )/.test(other));
      inline(element(made, "p"), rows.join(" "));
      at += rows.length;
    }
  }
  return made;
}

function taken(lines: readonly string[], from: number, belongs: (line: string) => boolean): string[] {
  let end = from + 1;
  while (end < lines.length && belongs(lines[end]!)) end++;
  return lines.slice(from, end);
}

function table(parent: HTMLElement, rows: readonly string[]): void {
  rows.forEach((row, index) => {
    if (/^[\s|:-]+$/.test(row)) return;
    const line = element(parent, "tr");
    const cells = row.trim().replace(/^\||\|$/g, "").split(/(?<!\\)\|/);
    for (const cell of cells) inline(element(line, index === 0 ? "th" : "td"), cell.trim().replaceAll("\\|", "|"));
  });
}

function inline(parent: HTMLElement, source: string): void {
  for (const part of inlineParts(source)) parent.append(part.kind === "text" ? part.text : text(part.kind, part.text));
}

/** A stretch of a line, as it is shown. */
export interface Part {
  readonly kind: "text" | "code" | "strong" | "em";
  readonly text: string;
}

const MARKS = "[\\\\`*_{}[\\]()#+\\-.!|<>~&@:=]";
const INLINE = new RegExp(
  `((?:\\\\${MARKS})+)|(\`+)(?!\`)(.+?)(?<!\`)\\2(?!\`)|\\*\\*([^*]+)\\*\\*|(?<![\\w*])[*_]([^*_]+)[*_](?![\\w*])|\\[([^\\]]+)\\]\\([^)]*\\)`,
  "g",
);

/** Returns a line in code, bold, italics and text; of links the text alone. What stands behind a backslash is no mark. */
export function inlineParts(source: string): Part[] {
  const parts: Part[] = [];
  const add = (kind: Part["kind"], text: string) => {
    const last = parts.at(-1);
    if (kind === "text" && last?.kind === "text") parts[parts.length - 1] = { kind, text: last.text + text };
    else if (text !== "") parts.push({ kind, text });
  };
  let from = 0;
  for (const found of source.matchAll(INLINE)) {
    add("text", source.slice(from, found.index));
    const [, escapes, ticks, code, bold, italic, link] = found;
    if (escapes !== undefined) add("text", unescaped(escapes));
    else if (ticks !== undefined) add("code", code!.replace(/^ (`.*|.*`) $/, "$1"));
    else if (bold !== undefined) add("strong", unescaped(bold));
    else if (italic !== undefined) add("em", unescaped(italic));
    else for (const part of inlineParts(link!)) add(part.kind, part.text);
    from = found.index + found[0].length;
  }
  add("text", source.slice(from));
  return parts;
}

function unescaped(source: string): string {
  return source.replace(new RegExp(`\\\\(${MARKS})`, "g"), "$1");
}

function element(parent: Node, name: string): HTMLElement {
  return parent.appendChild(document.createElement(name));
}

function text(name: string, content: string): HTMLElement {
  const made = document.createElement(name);
  made.textContent = content;
  return made;
}
