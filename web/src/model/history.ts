/** A value with undo and redo. */

import { computed, signal } from "@preact/signals-core";

const STEPS_MAX = 200;

export class History<T> {
  readonly value;
  private readonly past = signal<readonly T[]>([]);
  private readonly future = signal<readonly T[]>([]);
  private lastKey = "";

  constructor(first: T) {
    this.value = signal(first);
  }

  readonly canUndo = computed(() => this.past.value.length > 0);
  readonly canRedo = computed(() => this.future.value.length > 0);

  /** Sets the value; changes in a row with the same key that is not empty, such as of one slider, are one step. */
  set(value: T, key = ""): void {
    if (key === "" || key !== this.lastKey) this.past.value = [...this.past.value.slice(-STEPS_MAX + 1), this.value.value];
    this.lastKey = key;
    this.future.value = [];
    this.value.value = value;
  }

  /** Begins anew with a value, without steps. */
  reset(value: T): void {
    this.past.value = [];
    this.future.value = [];
    this.lastKey = "";
    this.value.value = value;
  }

  /** Returns whether there was a step to undo. */
  undo(): boolean {
    return this.go(this.past, this.future);
  }

  redo(): boolean {
    return this.go(this.future, this.past);
  }

  private go(from: { value: readonly T[] }, to: { value: readonly T[] }): boolean {
    const found = from.value.at(-1);
    if (found === undefined) return false;
    from.value = from.value.slice(0, -1);
    to.value = [...to.value, this.value.value];
    this.value.value = found;
    this.lastKey = "";
    return true;
  }
}
