// Layout of the page. On a wide page: a strip along the top, controls at the right, plots below, the picture in the
// rest. On a phone plots and controls share a drawer at the bottom, with a tab for each.

import { h, setText } from './html';

interface Parts {
  strip: HTMLElement;
  buttons: HTMLElement[];
  over_view: HTMLElement[];
  plots: HTMLElement;
  controls: HTMLElement;
  dialogs: HTMLElement[];
}

type Tab = 'plots' | 'controls' | 'closed';

export class Layout {
  readonly view = h('main', { class: 'view', 'aria-label': 'The bed' });
  panels_shown: boolean;
  private readonly shell = h('div', { class: 'shell' });
  private readonly title = h('span', { class: 'title' });
  private readonly tabs = new Map<Tab, HTMLButtonElement>();

  constructor(panels_shown: boolean) {
    this.panels_shown = panels_shown;
  }

  assemble(parts: Parts): void {
    const tab = (name: Tab, label: string): HTMLButtonElement => {
      const button = h(
        'button',
        { type: 'button', class: 'tab', 'aria-expanded': 'false', onclick: () => this.toggleTab(name) },
        label,
      );
      this.tabs.set(name, button);
      return button;
    };
    this.view.append(...parts.over_view);
    this.shell.append(
      h(
        'header',
        { class: 'strip' },
        h('div', { class: 'brand' }, h('strong', {}, 'haptolith'), this.title),
        parts.strip,
        h('div', { class: 'strip-buttons' }, ...parts.buttons),
      ),
      this.view,
      h(
        'div',
        { class: 'drawer' },
        h('div', { class: 'tabs' }, tab('plots', 'Plots'), tab('controls', 'Controls')),
        parts.plots,
        parts.controls,
      ),
    );
    document.querySelector('#app')!.append(this.shell, ...parts.dialogs);
    this.showPanels(this.panels_shown);
    this.showTab('plots');
  }

  setTitle(title: string): void {
    setText(this.title, title);
    document.title = `${title}, haptolith`;
  }

  showPanels(show: boolean): void {
    this.panels_shown = show;
    this.shell.classList.toggle('bare', !show);
  }

  private toggleTab(name: Tab): void {
    this.showTab(this.shell.dataset.tab === name ? 'closed' : name);
  }

  private showTab(name: Tab): void {
    this.shell.dataset.tab = name;
    for (const [tab, button] of this.tabs) button.setAttribute('aria-expanded', String(tab === name));
  }
}
