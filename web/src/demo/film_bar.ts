// Controls below an animation: play, pause and seek.

import { h, setText } from '../panels/html';
import type { FilmProgram } from './film_program';

export function filmBar(film: FilmProgram): HTMLElement {
  const play = h('button', { type: 'button', class: 'film-play', onclick: () => toggle() }, 'Stop');
  const place = h('input', {
    type: 'range',
    min: film.start_s,
    max: film.end_s,
    step: 'any',
    value: film.start_s,
    'aria-label': 'Time of the animation',
  });
  const time = h('span', { class: 'numbers' });
  const show = (): void => {
    place.value = String(film.time_s);
    setText(time, `${film.time_s.toFixed(1)} / ${film.end_s.toFixed(1)} s`);
    setText(play, film.playing ? 'Stop' : 'Play');
  };
  const toggle = (): void => {
    film.toggle();
    show();
  };
  place.addEventListener('input', () => {
    film.seek(Number(place.value));
    show();
  });
  film.onTime = show;
  return h('div', { class: 'film-bar', role: 'group', 'aria-label': 'Film' }, play, place, time);
}
