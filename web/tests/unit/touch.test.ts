import { describe, expect, it } from 'vitest';
import { mustTouch, Touch } from '../../src/study/touch';

describe('a touch', () => {
  it('is what a force of the soil shows, and is remembered until something else is shown', () => {
    const touch = new Touch();
    expect(touch.felt([0, 0, 0.001])).toBe(false);
    expect(touch.felt([0, 0.03, 0.03])).toBe(true);
    expect(touch.felt([0, 0, 0])).toBe(true);
    touch.begin();
    expect(touch.felt([0, 0, 0])).toBe(false);
  });

  it('is asked for where a person ends an interval, and nowhere else', () => {
    expect(mustTouch({ phase: 'interval', button: 'Continue' })).toBe(true);
    expect(mustTouch({ phase: 'interval', button: null })).toBe(false);
    expect(mustTouch({ phase: 'break', button: 'Continue' })).toBe(false);
  });
});
