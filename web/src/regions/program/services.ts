/** What the editor asks of its source: forms of the answers, as `elitescript.assist` has them. */

import type { Studio } from "../../model/studio.ts";
import type { TextEdit } from "../../source/messages.ts";
import type { Place, Span } from "./positions.ts";

export interface CompletionItem {
  readonly label: string;
  readonly kind: string;
  readonly span: Span;
  readonly text: string;
  readonly snippet: string;
  readonly detail: string;
  readonly sort: string;
  readonly is_missing: boolean;
  readonly is_deprecated: boolean;
  readonly source: string;
  readonly documentation: string;
}

export interface Hover {
  readonly span: Span;
  readonly markdown: string;
}

export interface SignatureHelp {
  readonly label: string;
  readonly markdown: string;
  readonly parameters: readonly { readonly start: number; readonly end: number; readonly markdown: string }[];
  readonly active: number | null;
}

/** Names of the text: five numbers each, line, column, length, index in `types`, bits of `modifiers`. */
export interface Tokens {
  readonly types: readonly string[];
  readonly modifiers: readonly string[];
  readonly rows: readonly number[];
}

export interface Hint {
  readonly line: number;
  readonly column: number;
  readonly kind: string;
  readonly label: string;
  readonly tooltip: string;
}

export interface Fold {
  readonly line: number;
  readonly end_line: number;
}

export interface Action {
  readonly title: string;
  readonly edits: readonly TextEdit[];
  readonly is_preferred: boolean;
}

export interface Renaming {
  readonly edits: readonly TextEdit[];
  readonly refusal: string;
}

/** Asks for services about the present text; null where the source refuses, or has a newer text by then. */
export class Services {
  private readonly studio: Studio;

  constructor(studio: Studio) {
    this.studio = studio;
  }

  completion(place: Place): Promise<readonly CompletionItem[] | null> {
    return this.ask("completion", { ...place });
  }

  resolve({ label, kind, source }: CompletionItem): Promise<{ readonly documentation: string } | null> {
    return this.ask("resolve", { label, kind, source });
  }

  hover(place: Place): Promise<Hover | null> {
    return this.ask("hover", { ...place });
  }

  signature(place: Place): Promise<SignatureHelp | null> {
    return this.ask("signature", { ...place });
  }

  definition(place: Place): Promise<readonly Span[] | null> {
    return this.ask("definition", { ...place });
  }

  references(place: Place): Promise<readonly { readonly span: Span }[] | null> {
    return this.ask("references", { ...place });
  }

  rename(place: Place, name: string): Promise<Renaming | null> {
    return this.ask("rename", { ...place, new_name: name });
  }

  actions(span: Span): Promise<readonly Action[] | null> {
    return this.ask("actions", { ...span });
  }

  format(): Promise<readonly TextEdit[] | null> {
    return this.ask("format", {});
  }

  tokens(): Promise<Tokens | null> {
    return this.ask("tokens", {});
  }

  hints(): Promise<readonly Hint[] | null> {
    return this.ask("hints", {});
  }

  /** What follows from a character that was typed: indentation, the `end` of a block. */
  typing(place: Place, typed: string): Promise<readonly TextEdit[] | null> {
    return this.ask("typing", { ...place, typed });
  }

  folding(): Promise<readonly Fold[] | null> {
    return this.ask("folding", {});
  }

  private async ask<Result>(service: Parameters<Studio["ask"]>[0], given: Parameters<Studio["ask"]>[1]): Promise<Result | null> {
    if (!this.studio.can("services")) return null;
    const version = this.studio.version.peek();
    try {
      const result = await this.studio.ask(service, given);
      return version === this.studio.version.peek() ? (result as Result | null) : null;
    } catch {
      // Refused because the text has changed, or the link was lost: the next look asks again.
      return null;
    }
  }
}
