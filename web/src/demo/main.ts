// The page with the soil inside: nothing is installed, and nothing leaves this browser. The address selects a scene, or
// an animation with `?play=`.

import '../style.css';
import './demo.css';
import { openBedPage } from '../bed_page';
import { h, setText } from '../panels/html';
import { readSettings } from '../settings';
import { addressOf, readShown } from './address';
import { readFilm } from './film';
import { filmBar } from './film_bar';
import { FilmProgram } from './film_program';
import type { DemoScene } from './messages';
import { WorkerProgram } from './worker_program';

const DROPPED = 'dropped';
const shown = readShown(location.search);
const settings = readSettings(location.search, matchMedia('(prefers-color-scheme: light)').matches);

const cover_text = h('p', { role: 'status' }, 'Loading…');
const cover = h('div', { class: 'demo-cover' }, h('span', { class: 'spinner', 'aria-hidden': 'true' }), cover_text);

function fail(why: string): void {
  cover.classList.add('failed');
  cover.replaceChildren(
    h('p', { role: 'alert' }, `Cannot display this: ${why}`),
    h('p', {}, h('a', { href: '?' }, 'Open the first scene')),
  );
  document.body.append(cover);
}

document.body.append(cover);
const film = new URLSearchParams(location.search).get('play');
if (film === null) openScene();
else openFilm(film).catch((error: unknown) => fail(error instanceof Error ? error.message : String(error)));

// An animation file that is dropped on the page is played, and not taken for a mesh file. The page is reloaded for it,
// and finds it in the browser's storage.
addEventListener('dragover', (event) => event.preventDefault());
addEventListener(
  'drop',
  (event) => {
    const file = event.dataTransfer?.files[0];
    if (!file?.name.endsWith('.film')) return;
    event.preventDefault();
    event.stopImmediatePropagation();
    caches
      .open(DROPPED)
      .then((kept) => kept.put(DROPPED, new Response(file)))
      .then(() => location.assign(`?play=${DROPPED}`))
      .catch(() =>
        fail('this browser cannot store the file; put the animation next to the page and open ?play=NAME.film'),
      );
  },
  { capture: true },
);

function openScene(): void {
  const scenes = h('select', { class: 'demo-scene', 'aria-label': 'Scene', title: 'Another scene' });
  scenes.addEventListener('change', () => location.assign(`?scene=${encodeURIComponent(scenes.value)}`));
  const share = h('button', { type: 'button', class: 'quiet', title: 'Copy the address of this scene' }, 'Share');
  const program = new WorkerProgram(shown.scene, shown.changes, {
    opened: (list) => {
      cover.remove();
      showScenes(scenes, list);
    },
    settling: (time_s) => setText(cover_text, `Soil is settling: ${time_s.toFixed(1)} s`),
    failed: fail,
  });
  const page = openBedPage(settings, program, [scenes, share]);
  if (shown.eye) page.stage.orbit.moveTo(shown.eye);

  share.addEventListener('click', () => {
    void program
      .changes()
      .then(async (changes) => {
        const looks = { colour: page.colour(), drawing: page.drawing() };
        const address = addressOf(
          location.href,
          { scene: shown.scene, changes, eye: page.stage.orbit.moved_to },
          looks,
        );
        history.replaceState(null, '', address);
        await navigator.clipboard.writeText(address);
        page.notices.toast('Address copied. It opens this scene with level soil.');
      })
      .catch(() => page.notices.toast('Copy the address of this scene from the address bar.'));
  });
}

function showScenes(scenes: HTMLSelectElement, list: DemoScene[]): void {
  const all = list.some(({ name }) => name === shown.scene)
    ? list
    : [...list, { name: shown.scene, title: shown.scene }];
  scenes.replaceChildren(
    ...all.map(({ name, title }) => h('option', { value: name, selected: name === shown.scene }, title)),
  );
}

/** @param address  address of an animation: next to the page, or on a server that allows this page to read it */
async function openFilm(address: string): Promise<void> {
  setText(cover_text, 'Loading the animation…');
  const kept = address === DROPPED ? await caches.match(DROPPED) : undefined;
  const answer = kept ?? (await fetch(address).catch(() => null));
  if (!answer?.ok) throw new Error(`cannot load the animation from ${address}`);
  const program = new FilmProgram(readFilm(await answer.arrayBuffer()));
  cover.remove();
  document.body.classList.add('of-film');
  const page = openBedPage(settings, program);
  page.stage.renderer.domElement.parentElement!.append(filmBar(program));
  if (shown.eye) page.stage.orbit.moveTo(shown.eye);
}
