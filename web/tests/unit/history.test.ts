import { describe, expect, it } from 'vitest';
import { History, lonely } from '../../src/panels/history';

function filled(...times_s: number[]): History {
  const history = new History(1);
  for (const time_s of times_s) history.add(time_s, [time_s]);
  return history;
}

describe('the history of a plot', () => {
  it('joins what came one after the other', () => {
    expect(filled(0, 0.016, 0.032, 0.132).table()[1]).not.toContain(null);
  });

  it('leaves a gap where nothing came', () => {
    const [x, y] = filled(1, 1.016, 3, 3.016).table();
    expect(y).toHaveLength(5);
    expect(y![2]).toBeNull();
    expect(x[2]).toBeGreaterThan(x[1]!);
    expect(x[2]).toBeLessThan(x[3]!);
    expect(y!.filter((value) => value !== null)).toHaveLength(4);
  });

  it('begins without a gap, and anew when time goes back', () => {
    expect(filled(5).table()[1]).toEqual([5]);
    expect(filled(5, 5.016, 1).table()[1]).toEqual([1]);
  });

  it('keeps ten seconds', () => {
    const [x] = filled(...Array.from({ length: 1500 }, (_, i) => i / 60)).table();
    expect(x.at(-1)).toBe(0);
    expect(x[0]).toBeGreaterThanOrEqual(-10);
    expect(x[0]).toBeLessThan(-9.9);
  });
});

describe('a value with a gap on both sides', () => {
  it('is found, and no other', () => {
    expect(lonely([1, null, 2, null, 3, 4, null, 5])).toEqual([0, 2, 7]);
    expect(lonely([1, 2, 3])).toEqual([]);
  });
});
