// The psychometric function of a block: proportions of "more" as points that grow with the number of responses, the
// fitted curve, its threshold and the reference.

import type { BlockResult } from 'haptolith-protocol';
import { makeScale } from './plot_scale';

const MARGIN = { left: 40, right: 14, top: 26, bottom: 36 };
const PADDING = 0.06;
const SHARES = [0, 0.25, 0.5, 0.75, 1];

export interface Bounds {
  low: number;
  high: number;
}

/** Returns the range of the drawn values with a margin; a logarithmic axis has only positive values. */
export function boundsOf(block: BlockResult): Bounds {
  const all = [block.reference, ...block.levels.map(({ x }) => x), ...(block.curve ?? []).map(([x]) => x)];
  const values = all.filter((x) => Number.isFinite(x) && (!isLog(block) || x > 0));
  const low = Math.min(...values);
  const high = Math.max(...values);
  if (isLog(block)) {
    const factor = (high / low) ** PADDING || 1;
    return high > low ? { low: low / factor, high: high * factor } : { low: low / 2, high: high * 2 };
  }
  const pad = high > low ? PADDING * (high - low) : Math.abs(low) / 2 || 1;
  return { low: low - pad, high: high + pad };
}

/** Whether the axis is logarithmic: only if all values are positive. */
export function isLog(block: BlockResult): boolean {
  return block.log_axis && block.reference > 0 && block.levels.every(({ x }) => x > 0);
}

/** Returns the value of the curve at x, by linear interpolation; null outside of it. */
export function shareAt(curve: readonly [number, number][], x: number): number | null {
  for (let i = 1; i < curve.length; ++i) {
    const [x0, p0] = curve[i - 1]!;
    const [x1, p1] = curve[i]!;
    if (x0 <= x && x <= x1) return x1 > x0 ? p0 + ((x - x0) / (x1 - x0)) * (p1 - p0) : p1;
  }
  return null;
}

/** Returns the radius of the point of n responses: its area grows with n. */
export function pointRadius(n: number): number {
  return Math.min(13, 3 * Math.sqrt(n));
}

export function drawPsychometric(block: BlockResult, width: number, height: number): SVGSVGElement {
  const { low, high } = boundsOf(block);
  const left = MARGIN.left;
  const right = width - MARGIN.right;
  const bottom = height - MARGIN.bottom;
  const x = makeScale(low, high, left, right, isLog(block));
  const y = makeScale(0, 1, bottom, MARGIN.top, false);
  const picture = s('svg', {
    class: 'psychometric',
    width,
    height,
    role: 'img',
    'aria-label': describe(block),
  });
  for (const share of SHARES) {
    picture.append(
      line('grid', left, y.px(share), right, y.px(share)),
      label('tick', left - 7, y.px(share) + 4, `${100 * share}`, 'end'),
    );
  }
  for (const tick of x.ticks) {
    picture.append(
      line('tick-mark', x.px(tick), bottom, x.px(tick), bottom + 4),
      label('tick', x.px(tick), bottom + 16, String(tick)),
    );
  }
  picture.append(
    line('axis', left, bottom, right, bottom),
    label('axis-label', (left + right) / 2, height - 4, block.axis_label),
    label('axis-label', 8, 12, '% said “more”', 'start'),
    label('tick', x.px(block.reference), 12, 'reference'),
    line('reference', x.px(block.reference), 16, x.px(block.reference), bottom),
    ...curveOf(block, x.px, y.px, bottom),
    ...block.levels.filter(({ n }) => n > 0).map((level) => pointOf(level, x.px, y.px)),
  );
  return picture;
}

function curveOf(
  { curve, threshold }: BlockResult,
  x_px: (x: number) => number,
  y_px: (p: number) => number,
  bottom: number,
): SVGElement[] {
  if (!curve) return [];
  const path = curve.map(([x, p], i) => `${i === 0 ? 'M' : 'L'}${x_px(x).toFixed(1)} ${y_px(p).toFixed(1)}`).join('');
  const parts: SVGElement[] = [s('path', { class: 'curve', d: path })];
  const share = threshold === null ? null : shareAt(curve, threshold);
  if (threshold !== null && share !== null)
    parts.unshift(line('threshold', x_px(threshold), y_px(share), x_px(threshold), bottom));
  return parts;
}

function pointOf(
  { x, k, n }: { x: number; k: number; n: number },
  x_px: (x: number) => number,
  y_px: (p: number) => number,
): SVGElement {
  const point = s('circle', { class: 'point', cx: x_px(x), cy: y_px(k / n), r: pointRadius(n) });
  const title = s('title', {});
  title.textContent = `at ${x}: ${k} of ${n}`;
  point.append(title);
  return point;
}

function describe({ name, levels, threshold }: BlockResult): string {
  const points = levels.filter(({ n }) => n > 0).map(({ x, k, n }) => `at ${x}: ${k} of ${n}`);
  return `${name}: ${points.join(', ') || 'no responses yet'}` + (threshold === null ? '' : `; threshold ${threshold}`);
}

function s<K extends keyof SVGElementTagNameMap>(tag: K, attributes: Record<string, string | number>) {
  const element = document.createElementNS('http://www.w3.org/2000/svg', tag);
  for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, String(value));
  return element;
}

function line(name: string, x1: number, y1: number, x2: number, y2: number): SVGElement {
  return s('line', { class: name, x1, y1, x2, y2 });
}

function label(name: string, x: number, y: number, text: string, anchor = 'middle'): SVGElement {
  const element = s('text', { class: name, x, y, 'text-anchor': anchor });
  element.textContent = text;
  return element;
}
