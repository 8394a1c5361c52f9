// An act of a participant counts once: not immediately after a new screen appears, because the hand may still respond
// to the previous one, and not again until the next screen.

const SETTLE_MS = 200;

export class OneAct {
  private shown_ms = -Infinity;
  private done = false;

  constructor(private readonly now_ms: () => number = () => performance.now()) {}

  /** Starts with a new screen. */
  renew(): void {
    this.settle();
    this.done = false;
  }

  /** Ignores acts for a moment, after something covered the screen: they may have been meant for that. */
  settle(): void {
    this.shown_ms = this.now_ms();
  }

  /** Whether an act counts now; if so the next one does not. */
  take(): boolean {
    if (this.done || this.now_ms() - this.shown_ms < SETTLE_MS) return false;
    this.done = true;
    return true;
  }

  /** Allows another attempt, because the act did not reach the program. */
  giveBack(): void {
    this.done = false;
  }
}
