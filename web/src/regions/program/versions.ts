/** Lines of the texts that ran, and where they are in the text of the editor, which may have changed since. */

import { ChangeSet, type Text } from "@codemirror/state";

interface Version {
  readonly version: number;
  readonly text: Text;
  /** What has changed since. */
  since: ChangeSet;
}

/** Texts that are kept while no run of a newer one begins, such as one that is typed and does not compile yet. */
const VERSIONS_MAX = 1000;
/** Characters of all of them, each counted whole: texts that are replaced as a whole share nothing. */
const CHARACTERS_MAX = 64e6;

export class Versions {
  private known: Version[] = [];
  private characters = 0;

  /** How many texts are kept. */
  get count(): number {
    return this.known.length;
  }

  /** Takes a version of the text; what changes from now on is counted against it. */
  begin(version: number, text: Text): void {
    this.known.push({ version, text, since: ChangeSet.empty(text.length) });
    this.characters += text.length;
    while (this.known.length > 1 && (this.known.length > VERSIONS_MAX || this.characters > CHARACTERS_MAX)) this.drop(1);
  }

  changed(changes: ChangeSet): void {
    for (const known of this.known) known.since = known.since.compose(changes);
  }

  /** Drops the texts in front of that of a version: runs of them are not asked about any more. */
  forget(version: number): void {
    const first = this.known.findLastIndex((known) => known.version <= version);
    if (first > 0) this.drop(first);
  }

  private drop(count: number): void {
    for (const { text } of this.known.splice(0, count)) this.characters -= text.length;
  }

  /** Returns the line that is now where a line of a version was; 0 if it was deleted, or the version is not known. */
  now(version: number, line: number, text: Text): number {
    const known = this.find(version);
    if (known === undefined || line < 1 || line > known.text.lines) return 0;
    const { from, to } = known.text.line(line);
    // A line whose whole text was replaced is another one.
    if (to > from && known.since.mapPos(from, 1) >= known.since.mapPos(to, -1)) return 0;
    return text.lineAt(known.since.mapPos(from + indentation(known.text, line), 1)).number;
  }

  /** Returns the line of a version that is now at a line; 0 if it is new. */
  then(version: number, line: number, text: Text): number {
    const known = this.find(version);
    if (known === undefined || line < 1 || line > text.lines) return 0;
    const back = known.since.invertedDesc;
    const { from, to } = text.line(line);
    if (to > from && back.mapPos(from, 1) >= back.mapPos(to, -1)) return 0;
    const old = known.text.lineAt(back.mapPos(Math.min(from + indentation(text, line), to), 1)).number;
    return this.now(version, old, text) === line ? old : 0;
  }

  /** The text of a version: options raise the version too, and leave the text. */
  private find(version: number): Version | undefined {
    return this.known.findLast((known) => known.version <= version);
  }
}

function indentation(text: Text, line: number): number {
  return /^\s*/.exec(text.line(line).text)![0].length;
}
