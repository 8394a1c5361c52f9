// Frame and label for the corner of the picture with a robot's site.

import type { Robot } from 'haptolith-protocol';
import { EXPLAIN } from './explanations';
import { h, setText } from './html';
import { explain } from './tooltip';

export class SiteCard {
  /** the area that the picture of the site fills */
  readonly window = h('div', { class: 'site-window' });
  private readonly title = h('span', { class: 'site-title', tabindex: 0 });
  readonly element = h('section', { class: 'site-card', 'aria-label': "The robot's site" }, this.title, this.window);

  constructor() {
    explain(this.title, EXPLAIN.site);
    this.setRobot(null);
  }

  /** Shows the state of a robot's site; null: no robot. */
  setRobot(robot: Robot | null): void {
    this.element.hidden = !robot?.site;
    if (robot) setText(this.title, `robot's site, ${(robot.behind / 1000).toFixed(1)} s ago`);
  }
}
