/** Elements, attributes and text of XML; enough for robot descriptions, and the same in every place that runs the page. */

export interface Element {
  readonly name: string;
  readonly attributes: { readonly [name: string]: string };
  readonly children: readonly Element[];
  /** Before the first child, and all of it where there is none. */
  readonly text: string;
  /** From 1. */
  readonly line: number;
}

const TOKEN = /<(?:!--|\?|!\[CDATA\[|!)|<(\/?)([\w:.-]+)((?:\s+[\w:.-]+\s*=\s*(?:"[^"]*"|'[^']*'))*)\s*(\/?)>|</g;
const DEPTH_MAX = 256;
const ATTRIBUTE = /([\w:.-]+)\s*=\s*(?:"([^"]*)"|'([^']*)')/g;
const ENTITIES: { readonly [name: string]: string } = { lt: "<", gt: ">", amp: "&", quot: '"', apos: "'" };

/** Returns the outermost element. Throws an Error that names the line. */
export function readXml(text: string): Element {
  const open: (Omit<Element, "children" | "text"> & { children: Element[]; text: string; end: number })[] = [];
  let root: Element | null = null;
  let line = 1;
  let at = 0;
  /** Takes the text before a token for the element that is open. */
  const keep = (until: number) => {
    const last = open.at(-1);
    if (last !== undefined && last.children.length === 0) last.text += text.slice(last.end, until);
  };
  const tokens = new RegExp(TOKEN);
  for (let token = tokens.exec(text); token !== null; token = tokens.exec(text)) {
    const [first, slash, name, attributes, isEmpty] = token;
    const end = ENDS[first];
    const whole = end === undefined ? first : text.slice(token.index, endOf(text, tokens.lastIndex, end, () => line));
    tokens.lastIndex = token.index + whole.length;
    for (; at < token.index; at++) if (text[at] === "\n") line++;
    if (whole === "<") throw new Error(`line ${line}: this is not XML`);
    keep(token.index);
    if (open.length > 0) open.at(-1)!.end = token.index + whole.length;
    if (name === undefined) continue;
    if (slash === "/") {
      const last = open.pop();
      if (last?.name !== name) throw new Error(`line ${line}: </${name}> closes nothing${last === undefined ? "" : `; <${last.name}> of line ${last.line} is open`}`);
      continue;
    }
    const element = { name, attributes: attributesOf(attributes ?? ""), children: [], text: "", end: token.index + whole.length, line };
    if (open.length > 0) open.at(-1)!.children.push(element);
    else if (root === null) root = element;
    else throw new Error(`line ${line}: a second outermost element <${name}>`);
    if (isEmpty !== "/") open.push(element);
    if (open.length > DEPTH_MAX) throw new Error(`line ${line}: more than ${DEPTH_MAX} elements inside of each other`);
  }
  if (open.length > 0) throw new Error(`<${open.at(-1)!.name}> of line ${open.at(-1)!.line} is never closed`);
  if (root === null) throw new Error("there is no element in it");
  return root;
}

/** Ends of what is passed over. */
const ENDS: { readonly [begin: string]: string } = { "<!--": "-->", "<?": "?>", "<![CDATA[": "]]>", "<!": ">" };

function endOf(text: string, from: number, end: string, line: () => number): number {
  const found = text.indexOf(end, from);
  if (found < 0) throw new Error(`${end} is missing after line ${line()}`);
  return found + end.length;
}

function attributesOf(text: string): { [name: string]: string } {
  const found: { [name: string]: string } = {};
  for (const [, name, double, single] of text.matchAll(ATTRIBUTE)) {
    found[name!] = (double ?? single ?? "").replace(/&(\w+);/g, (entity, word: string) => ENTITIES[word] ?? entity);
  }
  return found;
}

/** Returns the first child of a name. */
export function child(element: Element | undefined, name: string): Element | undefined {
  return element?.children.find((other) => other.name === name);
}

/** Returns the children of a name. */
export function children(element: Element | undefined, name: string): readonly Element[] {
  return element?.children.filter((other) => other.name === name) ?? [];
}
