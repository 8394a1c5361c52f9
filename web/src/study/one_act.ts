// What a participant does counts once: not in the first moment of what is shown, when a hand may still mean what was
// shown before, and not again until something else is shown.

const SETTLE_MS = 200;

export class OneAct {
  private shown_ms = -Infinity;
  private done = false;

  constructor(private readonly now_ms: () => number = () => performance.now()) {}

  /** Something else is shown. */
  renew(): void {
    this.settle();
    this.done = false;
  }

  /** Something was in front of it: for a moment an act may be meant for that. */
  settle(): void {
    this.shown_ms = this.now_ms();
  }

  /** Whether an act counts now; if so the next one does not. */
  take(): boolean {
    if (this.done || this.now_ms() - this.shown_ms < SETTLE_MS) return false;
    this.done = true;
    return true;
  }

  /** It did not reach the program: it may be tried again. */
  giveBack(): void {
    this.done = false;
  }
}
