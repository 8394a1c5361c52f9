// The page with the soil in it: nothing is installed, and nothing leaves this browser. What it shows is in its address.

import '../style.css';
import './demo.css';
import { openBedPage } from '../bed_page';
import { h, setText } from '../panels/html';
import { readSettings } from '../settings';
import { addressOf, readShown } from './address';
import type { DemoScene } from './messages';
import { WorkerProgram } from './worker_program';

const shown = readShown(location.search);
const settings = readSettings(location.search, matchMedia('(prefers-color-scheme: light)').matches);

const scenes = h('select', { class: 'demo-scene', 'aria-label': 'Scene', title: 'Another scene' });
scenes.addEventListener('change', () => location.assign(`?scene=${encodeURIComponent(scenes.value)}`));
const share = h('button', { type: 'button', class: 'quiet', title: 'Copy an address that shows this scene' }, 'Share');
const cover_text = h('p', { role: 'status' }, 'Bringing the soil…');
const cover = h('div', { class: 'demo-cover' }, h('span', { class: 'spinner', 'aria-hidden': 'true' }), cover_text);
document.body.append(cover);

const program = new WorkerProgram(shown.scene, shown.changes, {
  opened: (list) => {
    cover.remove();
    showScenes(list);
  },
  settling: (time_s) => setText(cover_text, `Letting the soil settle: ${time_s.toFixed(1)} s`),
  failed: (why) => {
    cover.classList.add('failed');
    cover.replaceChildren(
      h('p', { role: 'alert' }, `This scene cannot be shown: ${why}`),
      h('p', {}, h('a', { href: '?' }, 'Open the first scene')),
    );
    document.body.append(cover);
  },
});
const page = openBedPage(settings, program, [scenes, share]);
if (shown.eye) page.stage.orbit.moveTo(shown.eye);

share.addEventListener('click', () => {
  void program
    .changes()
    .then(async (changes) => {
      const looks = { colour: page.colour(), drawing: page.drawing() };
      const address = addressOf(location.href, { scene: shown.scene, changes, eye: page.stage.orbit.moved_to }, looks);
      history.replaceState(null, '', address);
      await navigator.clipboard.writeText(address);
      page.notices.toast('The address is copied: whoever opens it sees this scene, with level soil.');
    })
    .catch(() => page.notices.toast('The address bar now has this scene: copy it from there.'));
});

function showScenes(list: DemoScene[]): void {
  const all = list.some(({ name }) => name === shown.scene)
    ? list
    : [...list, { name: shown.scene, title: shown.scene }];
  scenes.replaceChildren(
    ...all.map(({ name, title }) => h('option', { value: name, selected: name === shown.scene }, title)),
  );
}
