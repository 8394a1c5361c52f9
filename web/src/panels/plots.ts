// Plots of the last ten seconds: force, torque, and the duration of ticks compared with the available millisecond.

import type { Frame } from 'haptolith-protocol';
import uPlot from 'uplot';
import 'uplot/dist/uPlot.min.css';
import { History, lonely, SPAN_S, type Table } from './history';
import { h } from './html';

const DRAW_INTERVAL_MS = 66;
const DESCRIBE_INTERVAL_MS = 1000;
const DEADLINE_US = 1000;

interface Line {
  name: string;
  /** CSS variable with its colour */
  colour: string;
  width: number;
  points?: boolean;
  /** an edge of the band, which is filled between two of them and has one key */
  edge?: 'low' | 'high';
  explains?: string;
}

export interface PlotSpec {
  title: string;
  unit: string;
  /** CSS variable with the colour of its arrow in the picture */
  arrow?: string;
  lines: Line[];
  /** Returns a value for each line; `late`: a tick has been late since the frame before. */
  sample: (frame: Frame, late: boolean) => number[];
  range: (low: number, high: number) => [number, number];
  log?: boolean;
  deadline?: boolean;
  digits?: number;
}

/** Returns bounds that move in steps, and never closer than `least` around 0. */
export function steppedRange(least: number): (low: number, high: number) => [number, number] {
  return (low, high) => {
    const step = (value: number): number => {
      const size = Math.max(Math.abs(value) * 1.05, least);
      const decade = 10 ** Math.floor(Math.log10(size));
      const nice = [1, 1.5, 2, 3, 4, 5, 6, 8, 10].find((factor) => factor * decade >= size) ?? 10;
      return nice * decade;
    };
    return [low < -0.02 * least ? -step(low) : -0.25 * least, step(high)];
  };
}

const AXES: Line[] = [
  { name: 'x', colour: '--plot-x', width: 1.25 },
  { name: 'y', colour: '--plot-y', width: 1.25 },
  { name: 'z', colour: '--plot-z', width: 1.25 },
  { name: 'magnitude', colour: '--plot-size', width: 1.75 },
];

const BAND: Line[] = [
  {
    name: 'band',
    colour: '--plot-band',
    width: 0,
    edge: 'high',
    explains:
      'Band of 90 %, mean over 0.25 s: what another specimen of this soil with particles half as large would show.',
  },
  { name: '', colour: '--plot-band', width: 0, edge: 'low' },
];

const withMagnitude = (values: readonly number[]): number[] => [...values, Math.hypot(...values)];

const SPECS: PlotSpec[] = [
  {
    title: 'Force',
    unit: 'N',
    arrow: '--force',
    lines: [...BAND, ...AXES],
    sample: (frame) => {
      const band = frame.bands[0];
      return [band?.high_n ?? NaN, band?.low_n ?? NaN, ...withMagnitude(frame.force_n)];
    },
    range: steppedRange(0.5),
  },
  {
    title: 'Torque',
    unit: 'mN m',
    arrow: '--torque',
    lines: AXES,
    sample: (frame) => withMagnitude(frame.torque_nm.map((value) => value * 1000)),
    range: steppedRange(5),
  },
  {
    title: 'Longest tick',
    unit: 'µs',
    lines: [
      { name: 'tick', colour: '--plot-z', width: 1.25 },
      {
        name: 'wake-up delay',
        colour: '--late',
        width: 0,
        points: true,
        explains:
          'A tick was late. On the dashed line: the loop was woken late. ' + 'Above it: the tick took too long.',
      },
    ],
    sample: (frame, late) => {
      const tick_us = Math.max(1, frame.longestTick_us);
      return [tick_us, late ? Math.max(tick_us, DEADLINE_US) : NaN];
    },
    range: () => [1, 10_000],
    log: true,
    deadline: true,
  },
];

/** Describes a plot for screen readers: current value and range of each line. */
export function inWords(spec: Pick<PlotSpec, 'title' | 'unit' | 'lines'>, [, ...columns]: Table): string {
  const number = (value: number): string => String(Number(value.toPrecision(3)));
  const lines = spec.lines.flatMap((line, i) => {
    const values = (columns[i] ?? []).filter((value) => value !== null);
    if (values.length === 0 || line.edge) return [];
    if (line.points) return [`${line.name} ${values.length} ${values.length === 1 ? 'time' : 'times'}`];
    const [low, high] = [Math.min(...values), Math.max(...values)];
    return [`${line.name} ${number(values.at(-1)!)}, from ${number(low)} to ${number(high)}`];
  });
  return `${spec.title} in ${spec.unit} over the last ten seconds. ${lines.length ? lines.join('; ') : 'No data yet'}.`;
}

export class Plots {
  readonly element: HTMLElement;
  private readonly histories: History[];
  private plots: uPlot[] = [];
  private readonly hosts: HTMLElement[] = [];
  private drawn_ms = 0;
  private described_ms = -Infinity;
  private stale = false;
  private misses: number | null = null;
  private band_shown = true;

  constructor(private readonly specs: readonly PlotSpec[] = SPECS) {
    this.histories = specs.map((spec) => new History(spec.lines.length));
    const figures = specs.map((spec) => {
      const host = h('div', { class: 'plot-host', role: 'img', 'aria-label': spec.title });
      this.hosts.push(host);
      const keys = spec.lines
        .filter((line) => line.name)
        .map((line) =>
          h(
            'span',
            { class: line.edge ? 'plot-key band' : 'plot-key', title: line.explains },
            h('i', { class: line.points ? 'point' : null, style: `background:var(${line.colour})` }),
            line.name,
          ),
        );
      if (spec.deadline)
        keys.push(h('span', { class: 'plot-key', title: 'time limit of a tick' }, h('i', { class: 'dashed' }), '1 ms'));
      return h(
        'figure',
        { class: 'plot' },
        h(
          'figcaption',
          {},
          spec.arrow && h('i', { class: 'swatch', style: `background:var(${spec.arrow})`, 'aria-hidden': 'true' }),
          h('strong', {}, spec.title),
          h('span', { class: 'unit' }, spec.unit),
          ...keys,
        ),
        host,
      );
    });
    this.element = h('section', { class: 'plots', 'aria-label': 'The last ten seconds', tabindex: 0 }, ...figures);
    new ResizeObserver(() => this.fit()).observe(this.element);
  }

  /** Redraws the plots in the colours of the page. */
  restyle(): void {
    for (const plot of this.plots) plot.destroy();
    const style = getComputedStyle(document.documentElement);
    const colour = (name: string): string => style.getPropertyValue(name).trim();
    this.plots = this.specs.map((spec, i) =>
      drawnByProcessor(() => new uPlot(this.options(spec, i, colour), this.histories[i]!.table(), this.hosts[i]!)),
    );
    this.stale = true;
  }

  /** Shows or hides the band around the force. */
  toggleBand(): void {
    this.band_shown = !this.band_shown;
    this.element.classList.toggle('without-band', !this.band_shown);
    this.specs.forEach((spec, i) =>
      spec.lines.forEach((line, k) => line.edge && this.plots[i]?.setSeries(k + 1, { show: this.band_shown })),
    );
  }

  clear(): void {
    this.misses = null;
  }

  setFrame(frame: Frame): void {
    const late = this.misses !== null && frame.misses > this.misses;
    this.misses = frame.misses;
    this.specs.forEach((spec, i) => this.histories[i]!.add(frame.time_s, spec.sample(frame, late)));
    this.stale = true;
  }

  tick(now_ms: number): void {
    if (!this.stale || now_ms - this.drawn_ms < DRAW_INTERVAL_MS || this.element.clientWidth === 0) return;
    this.drawn_ms = now_ms;
    this.stale = false;
    const tables = this.histories.map((history) => history.table());
    this.plots.forEach((plot, i) => plot.setData(tables[i]!));
    if (now_ms - this.described_ms < DESCRIBE_INTERVAL_MS) return;
    this.described_ms = now_ms;
    this.hosts.forEach((host, i) => host.setAttribute('aria-label', inWords(this.specs[i]!, tables[i]!)));
  }

  private fit(): void {
    this.plots.forEach((plot, i) => {
      const host = this.hosts[i]!;
      const width = host.clientWidth;
      const height = host.clientHeight;
      if (width > 0 && height > 0 && (plot.width !== width || plot.height !== height)) plot.setSize({ width, height });
    });
  }

  private options(spec: PlotSpec, index: number, colour: (name: string) => string): uPlot.Options {
    const host = this.hosts[index]!;
    const grid = { stroke: colour('--plot-grid'), width: 1 };
    const axis: uPlot.Axis = {
      stroke: colour('--muted'),
      font: '12px system-ui, sans-serif',
      grid,
      ticks: { show: false },
      gap: 4,
    };
    return {
      width: Math.max(120, host.clientWidth),
      height: Math.max(60, host.clientHeight),
      legend: { show: false },
      cursor: { show: false },
      padding: [6, 16, 0, 0],
      pxAlign: true,
      scales: {
        x: { time: false, range: [-SPAN_S, 0] },
        y: {
          distr: spec.log ? 3 : 1,
          range: (_plot, low, high) => spec.range(low ?? 0, high ?? 0),
        },
      },
      axes: [
        {
          ...axis,
          size: 20,
          values: (_plot, ticks) =>
            ticks.map((tick) => (tick === 0 ? 'now' : tick === -SPAN_S ? '' : `${tick} s`.replace('-', '\u2212'))),
        },
        {
          ...axis,
          size: 44,
          splits: spec.log ? () => [1, 10, 100, 1000, 10_000] : undefined,
          space: 24,
          values: (_plot, ticks) =>
            ticks.map((tick) => (tick === null ? '' : String(Number(tick.toPrecision(4))).replace('-', '\u2212'))),
        },
      ],
      series: [
        {},
        ...spec.lines.map((line): uPlot.Series => ({
          show: line.edge === undefined || this.band_shown,
          stroke: line.edge ? 'transparent' : colour(line.colour),
          width: line.width,
          paths: line.points ? () => null : undefined,
          points: line.edge
            ? { show: false }
            : line.points
              ? { show: true, size: 6, fill: colour(line.colour) }
              : {
                  show: true,
                  size: 2 * line.width,
                  fill: colour(line.colour),
                  filter: (plot, series) => lonely(plot.data[series]!),
                },
          spanGaps: false,
        })),
      ],
      bands: spec.lines.some((line) => line.edge) ? [{ series: [1, 2], fill: colour('--plot-band') }] : [],
      hooks: spec.deadline ? { draw: [(plot) => drawDeadline(plot, colour('--late'))] } : {},
    };
  }
}

/** Makes a plot whose canvas is drawn by the processor. Without a graphics card, a browser that emulates one takes
 * 100 times as long for lines. uPlot has no option for it. */
function drawnByProcessor(make: () => uPlot): uPlot {
  const usual = HTMLCanvasElement.prototype.getContext;
  HTMLCanvasElement.prototype.getContext = function (this: HTMLCanvasElement, kind: string) {
    return usual.call(this, kind, { willReadFrequently: true });
  } as typeof usual;
  try {
    return make();
  } finally {
    HTMLCanvasElement.prototype.getContext = usual;
  }
}

function drawDeadline(plot: uPlot, colour: string): void {
  const { ctx, bbox } = plot;
  const y = plot.valToPos(DEADLINE_US, 'y', true);
  ctx.save();
  ctx.strokeStyle = colour;
  ctx.lineWidth = devicePixelRatio;
  ctx.setLineDash([6 * devicePixelRatio, 5 * devicePixelRatio]);
  ctx.beginPath();
  ctx.moveTo(bbox.left, y);
  ctx.lineTo(bbox.left + bbox.width, y);
  ctx.stroke();
  ctx.restore();
}
