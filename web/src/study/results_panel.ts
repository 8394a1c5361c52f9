// A psychometric function for each block.

import type { BlockResult } from 'haptolith-protocol';
import { h, setText } from '../panels/html';
import { drawPsychometric } from './psychometric_plot';

const number = (value: number): string => String(Number(value.toPrecision(3)));

export class ResultsPanel {
  readonly element = h('section', { class: 'results', 'aria-label': 'Psychometric functions' });
  private blocks: BlockResult[] = [];
  private figures: { host: HTMLElement; facts: HTMLElement; name: HTMLElement }[] = [];
  private shown = '';

  constructor() {
    new ResizeObserver(() => this.draw()).observe(this.element);
  }

  /** Shows the results; `blinded`: nothing, because a moving curve would reveal the last response. */
  set(blocks: BlockResult[], blinded: boolean): void {
    const shown = JSON.stringify([blocks, blinded]);
    if (shown === this.shown) return;
    this.shown = shown;
    this.element.hidden = blinded;
    if (blinded) return;
    this.blocks = blocks;
    if (this.figures.length !== blocks.length) this.makeFigures(blocks.length);
    this.draw();
  }

  private makeFigures(count: number): void {
    this.figures = Array.from({ length: count }, () => ({
      host: h('div', { class: 'result-host' }),
      facts: h('span', { class: 'result-facts numbers' }),
      name: h('strong', {}),
    }));
    this.element.replaceChildren(
      ...this.figures.map(({ host, facts, name }) =>
        h('figure', { class: 'result' }, h('figcaption', {}, name, facts), host),
      ),
    );
  }

  private draw(): void {
    this.blocks.forEach((block, i) => {
      const { host, facts, name } = this.figures[i]!;
      setText(name, block.name);
      setText(facts, factsOf(block));
      const { clientWidth: width, clientHeight: height } = host;
      if (width > 0 && height > 0) host.replaceChildren(drawPsychometric(block, width, height));
    });
  }
}

function factsOf({ threshold, weber_fraction, levels }: BlockResult): string {
  const answers = levels.reduce((sum, { n }) => sum + n, 0);
  if (threshold === null) return answers === 0 ? 'no responses yet' : 'too few responses for a curve';
  return `PSE ${number(threshold)}` + (weber_fraction === null ? '' : ` · Weber fraction ${number(weber_fraction)}`);
}
