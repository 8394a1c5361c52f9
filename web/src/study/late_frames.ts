// Pictures that are seen later than what they show is felt (docs/reference/protocol-keys.md, `visual_delay_s`).

import type { Frame } from 'haptolith-protocol';

/** Holds frames back for a while. None is left out and the order stays: a frame tells only what has moved since the last. */
export class LateFrames {
  private delay_ms = 0;
  private readonly waiting: { frame: Frame; came_ms: number }[] = [];

  constructor(private readonly show: (frame: Frame) => void) {}

  setDelay(delay_s: number, now_ms: number): void {
    this.delay_ms = 1000 * delay_s;
    this.tick(now_ms);
  }

  add(frame: Frame, now_ms: number): void {
    this.waiting.push({ frame, came_ms: now_ms });
    this.tick(now_ms);
  }

  /** Another bed lies there: what is late of the one before will never be seen. */
  clear(): void {
    this.waiting.length = 0;
  }

  /** Shows what is due; to be called often. */
  tick(now_ms: number): void {
    while (this.waiting.length > 0 && this.waiting[0]!.came_ms + this.delay_ms <= now_ms) {
      this.show(this.waiting.shift()!.frame);
    }
  }
}
