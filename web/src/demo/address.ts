// Scene and view in an address, so that a link shows the same again: `?scene=moon&set=soil.radius_mm=4`.

import type { Settings } from '../settings';
import type { EyePlace } from '../view/camera';

export const FIRST_SCENE = 'moon';

export interface Shown {
  scene: string;
  /** changes to the scene: one "table.key=value" per line */
  changes: string;
  /** position of the eye; null: a named view */
  eye: EyePlace | null;
}

export function readShown(search: string): Shown {
  const query = new URLSearchParams(search);
  const eye = (query.get('eye') ?? '').split(',').map(Number);
  const [azimuth_deg, elevation_deg, zoom, x, y] = eye;
  return {
    scene: query.get('scene') ?? FIRST_SCENE,
    changes: query.getAll('set').join('\n'),
    eye:
      eye.length === 5 && eye.every(Number.isFinite)
        ? { azimuth_deg: azimuth_deg!, elevation_deg: elevation_deg!, zoom: zoom!, aside_m: [x!, y!] }
        : null,
  };
}

/** Returns an address of this page that shows the same scene and view. */
export function addressOf(page: string, shown: Shown, looks: Pick<Settings, 'colour' | 'drawing'>): string {
  const address = new URL(page);
  address.search = '';
  address.hash = '';
  const query = address.searchParams;
  query.set('scene', shown.scene);
  for (const change of shown.changes.split('\n')) if (change !== '') query.append('set', change);
  if (shown.eye) {
    const { azimuth_deg, elevation_deg, zoom, aside_m } = shown.eye;
    const short = (number: number, digits: number): string => String(Number(number.toFixed(digits)));
    query.set(
      'eye',
      [short(azimuth_deg, 1), short(elevation_deg, 1), short(zoom, 3), ...aside_m.map((x) => short(x, 4))].join(','),
    );
  }
  if (looks.colour !== 'plain') query.set('colour', looks.colour);
  if (looks.drawing !== 'grains') query.set('drawing', looks.drawing);
  return address.href;
}
