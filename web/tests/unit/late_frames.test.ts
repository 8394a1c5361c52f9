import type { Frame } from 'haptolith-protocol';
import { describe, expect, it } from 'vitest';
import { LateFrames } from '../../src/study/late_frames';

const frame = (number: number): Frame => ({ number }) as Frame;

function late(): { frames: LateFrames; shown: number[] } {
  const shown: number[] = [];
  return { frames: new LateFrames(({ number }) => shown.push(number)), shown };
}

describe('late frames', () => {
  it('are shown at once without a delay', () => {
    const { frames, shown } = late();
    frames.add(frame(1), 0);
    frames.add(frame(2), 16);
    expect(shown).toEqual([1, 2]);
  });

  it('are shown so much later, all of them and in their order', () => {
    const { frames, shown } = late();
    frames.setDelay(0.5, 0);
    for (let number = 0; number < 5; ++number) frames.add(frame(number), 100 * number);
    expect(shown).toEqual([]);
    frames.tick(499);
    expect(shown).toEqual([]);
    frames.tick(500);
    expect(shown).toEqual([0]);
    frames.add(frame(5), 820);
    expect(shown).toEqual([0, 1, 2, 3]);
    frames.tick(10_000);
    expect(shown).toEqual([0, 1, 2, 3, 4, 5]);
  });

  it('all come when the delay ends, so that nothing is missing afterwards', () => {
    const { frames, shown } = late();
    frames.setDelay(5, 0);
    frames.add(frame(1), 1000);
    frames.add(frame(2), 1016);
    frames.setDelay(0, 1020);
    expect(shown).toEqual([1, 2]);
  });

  it('are forgotten with their bed', () => {
    const { frames, shown } = late();
    frames.setDelay(1, 0);
    frames.add(frame(1), 0);
    frames.clear();
    frames.add(frame(2), 500);
    frames.tick(5000);
    expect(shown).toEqual([2]);
  });
});
