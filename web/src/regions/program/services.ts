/** What the editor asks of its source. */

import type { Studio } from "../../model/studio.ts";
import type { Json, Service } from "../../source/messages.ts";
import type { Completion, Results, Span } from "../../source/services.ts";
import type { Point } from "./positions.ts";

/** Answer of a service; null where the source refuses, or has a newer text by then. */
type Answer<S extends Service> = Promise<Results[S] | null>;

/** Asks for services about the present text. */
export class Services {
  private readonly studio: Studio;

  constructor(studio: Studio) {
    this.studio = studio;
  }

  completion(place: Point): Answer<"completion"> {
    return this.ask("completion", { ...place });
  }

  resolve({ label, kind, source }: Completion): Answer<"resolve"> {
    return this.ask("resolve", { label, kind, source });
  }

  hover(place: Point): Answer<"hover"> {
    return this.ask("hover", { ...place });
  }

  signature(place: Point): Answer<"signature"> {
    return this.ask("signature", { ...place });
  }

  definition(place: Point): Answer<"definition"> {
    return this.ask("definition", { ...place });
  }

  references(place: Point): Answer<"references"> {
    return this.ask("references", { ...place });
  }

  rename(place: Point, name: string): Answer<"rename"> {
    return this.ask("rename", { ...place, new_name: name });
  }

  actions(span: Span): Answer<"actions"> {
    return this.ask("actions", { ...span });
  }

  format(): Answer<"format"> {
    return this.ask("format", {});
  }

  tokens(): Answer<"tokens"> {
    return this.ask("tokens", {});
  }

  hints(): Answer<"hints"> {
    return this.ask("hints", {});
  }

  /** What follows from a character that was typed: indentation, the `end` of a block. */
  typing(place: Point, typed: string): Answer<"typing"> {
    return this.ask("typing", { ...place, typed });
  }

  folding(): Answer<"folding"> {
    return this.ask("folding", {});
  }

  private async ask<S extends Service>(service: S, given: { readonly [name: string]: Json }): Answer<S> {
    if (!this.studio.can("services")) return null;
    const version = this.studio.version.peek();
    try {
      const result = await this.studio.ask(service, given);
      return version === this.studio.version.peek() ? result : null;
    } catch {
      // Refused because the text has changed, or the link was lost: the next look asks again.
      return null;
    }
  }
}
