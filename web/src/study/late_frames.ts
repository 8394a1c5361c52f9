// Frames displayed with a delay relative to the rendered force (docs/reference/protocol-keys.md, `visual_delay_s`).

import type { Frame } from 'haptolith-protocol';

/** Delays frames. All are shown, and in order, because a frame contains only the changes since the last one. */
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

  /** Drops the waiting frames, because there is another bed. */
  clear(): void {
    this.waiting.length = 0;
  }

  /** Shows the frames that are due; to be called often. */
  tick(now_ms: number): void {
    while (this.waiting.length > 0 && this.waiting[0]!.came_ms + this.delay_ms <= now_ms) {
      this.show(this.waiting.shift()!.frame);
    }
  }
}
