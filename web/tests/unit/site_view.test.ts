import type { Site } from 'haptolith-protocol';
import { describe, expect, it } from 'vitest';
import { blockOf, isSame } from '../../src/view/site_view';

const site = (heights_mm: (number | null)[]): Site => ({
  corner_m: [-0.1, -0.2],
  cell_m: 0.1,
  columns: 3,
  rows: heights_mm.length / 3,
  heights_mm,
});

const triangles = (of: Site) => blockOf(of, 0.5).getIndex()!.count / 3;

describe("a robot's site", () => {
  it('has its surface through the middles of cells, over the surface of the bed', () => {
    const at = blockOf(site([0, 10, 20, -30, 0, 0]), 0.5).getAttribute('position');
    const point = (i: number) => [at.getX(i), at.getY(i), at.getZ(i)].map((value) => +value.toFixed(4));
    expect(point(0)).toEqual([-0.05, -0.15, 0.5]);
    expect(point(2)).toEqual([0.15, -0.15, 0.52]);
    expect(point(3)).toEqual([-0.05, -0.05, 0.47]);
    const lowest = Math.min(...Array.from({ length: at.count }, (_, i) => at.getZ(i)));
    expect(lowest).toBeLessThan(0.47);
  });

  it('has sides, whose triangles look outwards', () => {
    const block = blockOf(site([0, 0, 0, 0, 0, 0]), 0.5);
    expect(block.getIndex()!.count / 3).toBe(2 * 2 + 2 * (2 + 1 + 2 + 1));
    const normals = block.getAttribute('normal');
    const at = block.getAttribute('position');
    for (let i = 6; i < at.count; ++i) {
      const outwards = normals.getX(i) * (at.getX(i) - 0.05) + normals.getY(i) * (at.getY(i) + 0.1);
      expect(outwards).toBeGreaterThan(0);
      expect(normals.getZ(i)).toBeCloseTo(0);
    }
    for (let i = 0; i < 6; ++i) expect(normals.getZ(i)).toBeCloseTo(1);
  });

  it('has holes where nothing is known', () => {
    const whole = site([0, 0, 0, 0, 0, 0, 0, 0, 0]);
    expect(triangles(whole)).toBe(4 * 2 + 8 * 2);
    expect(triangles({ ...whole, heights_mm: [0, 0, 0, 0, null, 0, 0, 0, 0] })).toBe(8 * 2);
    expect(triangles({ ...whole, heights_mm: Array<null>(9).fill(null) })).toBe(0);
  });

  it('is another one when it has moved or has other cells', () => {
    const level = site([0, 0, null, 0, 0, 0]);
    expect(isSame(level, site([0, 0, null, 0, 0, 0]))).toBe(true);
    expect(isSame(level, site([0, 0, 0, 0, 0, 0]))).toBe(false);
    expect(isSame(level, { ...level, corner_m: [0.5, 0] })).toBe(false);
    expect(isSame(level, { ...level, cell_m: 2 * level.cell_m })).toBe(false);
  });
});
