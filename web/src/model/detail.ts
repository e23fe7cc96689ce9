/** Asks for every-tick rows of what is looked at closely, in blocks, once each. */

import type { Stretch } from "./playback.ts";
import type { Run } from "./run.ts";
import { TICK_S } from "../source/rows.ts";

/** Rows further apart than this many pixels are too coarse. */
const PIXELS_MOST = 3;

/** Distance of the rows that come by themselves, s. */
const COARSE_S = 0.04;

/** Length of a block, s: 500 rows. */
const BLOCK_S = 2;

/** How far ahead of playback, s. */
const AHEAD_S = 1;

export class Details {
  private run: Run | null = null;
  private readonly asked = new Set<number>();
  private isWaiting = false;
  private readonly ask: (from_s: number, to_s: number, step_s: number) => Promise<void>;

  /** @param ask asks the source for rows of the newest run, and ends when they are there. */
  constructor(ask: (from_s: number, to_s: number, step_s: number) => Promise<void>) {
    this.ask = ask;
  }

  /**
   * Asks for what is missing, if there is no answer to wait for.
   *
   * @param view what is drawn, over how many pixels.
   * @param playing the cursor while it moves by itself; else null.
   */
  async want(run: Run, view: Stretch, width: number, playing: number | null): Promise<void> {
    if (run !== this.run) {
      this.run = run;
      this.asked.clear();
      this.isWaiting = false;
    }
    if (this.isWaiting) return;
    const isCoarse = (COARSE_S / (view[1] - view[0])) * width > PIXELS_MOST;
    const blocks = this.missing(run, playing === null ? null : [playing, playing + AHEAD_S]) ?? (isCoarse ? this.missing(run, view) : null);
    if (blocks === null) return;
    for (let block = blocks[0]; block < blocks[1]; block++) this.asked.add(block);
    this.isWaiting = true;
    try {
      await this.ask(blocks[0] * BLOCK_S, Math.min(blocks[1] * BLOCK_S, run.known_s), TICK_S);
    } catch {
      // A source that refuses says so where it does; coarse rows stay.
    } finally {
      if (run === this.run) this.isWaiting = false;
    }
  }

  /** The first run of blocks, from one number to before another, that lie in a stretch and have not been asked for. */
  private missing(run: Run, stretch: Stretch | null): Stretch | null {
    if (stretch === null) return null;
    // A block that is not computed to its end comes later, unless the run ends in it.
    const known = run.ended === null ? Math.floor(run.known_s / BLOCK_S) : Math.ceil(run.known_s / BLOCK_S);
    const end = Math.min(Math.ceil(stretch[1] / BLOCK_S), known);
    const isMissing = (block: number) => !this.asked.has(block) && !run.samples.isFine(block * BLOCK_S, Math.min((block + 1) * BLOCK_S, run.known_s), TICK_S);
    let begin = Math.floor(stretch[0] / BLOCK_S);
    while (begin < end && !isMissing(begin)) begin++;
    let last = begin;
    while (last < end && isMissing(last)) last++;
    return begin < last ? [begin, last] : null;
  }
}
