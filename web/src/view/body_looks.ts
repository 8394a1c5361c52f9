// Appearance of each body: its sky, its sunlight and the colour of its soil. Colours are sRGB, as picked from a
// photograph; `three.Color` converts them to the linear values for lighting.

export interface BodyLook {
  /** colour of the sky at the zenith, and at the horizon */
  zenith: string;
  horizon: string;
  /** distance (in widths of the box) at which the ground fades into the horizon; airless bodies stay sharp */
  haze_widths: number;
  stars: number;
  /** apparent radius of the sun, in degrees, larger than life so that it can be seen */
  sun_radius_deg: number;
  sun: string;
  sun_strength: number;
  /** ambient light: sky and sunlit ground */
  fill: string;
  fill_strength: number;
  soil: string;
  /** weight of the scattering of an airless body: 0 matt, 1 as the Moon's; and its increase in brightness when
   * looking away from the sun (regolith_shader.ts) */
  lunar: number;
  surge: number;
  /** fraction of the fill light that reaches shadows */
  shadow_fill: number;
  companion: 'earth' | 'jupiter' | 'charon' | null;
}

const MOON: BodyLook = {
  zenith: '#000000',
  horizon: '#020203',
  haze_widths: 400,
  stars: 1,
  sun_radius_deg: 1.2,
  sun: '#fff8ee',
  sun_strength: 2.5,
  fill: '#c9d2e2',
  fill_strength: 0.5,
  soil: '#a3a09b',
  lunar: 1,
  surge: 0.9,
  shadow_fill: 0.16,
  companion: 'earth',
};

const LOOKS: Record<string, BodyLook> = {
  Moon: MOON,
  Mars: {
    zenith: '#9a7450',
    horizon: '#d9b083',
    haze_widths: 60,
    stars: 0,
    sun_radius_deg: 0.9,
    sun: '#fff0de',
    sun_strength: 1.9,
    fill: '#e3cbb0',
    fill_strength: 0.75,
    soil: '#ab7a58',
    lunar: 0.45,
    surge: 0.25,
    shadow_fill: 0.9,
    companion: null,
  },
  Earth: {
    zenith: '#2f6fb4',
    horizon: '#c4dcec',
    haze_widths: 90,
    stars: 0,
    sun_radius_deg: 1.2,
    sun: '#fff3dd',
    sun_strength: 1.9,
    fill: '#bcd4ee',
    fill_strength: 0.8,
    soil: '#cdae7e',
    lunar: 0.15,
    surge: 0.12,
    shadow_fill: 0.9,
    companion: null,
  },
  Europa: {
    zenith: '#000002',
    horizon: '#03050a',
    haze_widths: 400,
    stars: 0.9,
    sun_radius_deg: 0.4,
    sun: '#ffffff',
    sun_strength: 1.9,
    fill: '#bcd0e8',
    fill_strength: 0.65,
    soil: '#c9d4dc',
    lunar: 0.8,
    surge: 0.5,
    shadow_fill: 0.3,
    companion: 'jupiter',
  },
  Ceres: {
    zenith: '#000000',
    horizon: '#020203',
    haze_widths: 400,
    stars: 1,
    sun_radius_deg: 0.5,
    sun: '#fffaf2',
    sun_strength: 2.6,
    fill: '#c8cdd6',
    fill_strength: 0.55,
    soil: '#75726f',
    lunar: 1,
    surge: 0.9,
    shadow_fill: 0.16,
    companion: null,
  },
  Pluto: {
    zenith: '#010104',
    horizon: '#161d33',
    haze_widths: 160,
    stars: 1,
    sun_radius_deg: 0.22,
    sun: '#ffffff',
    sun_strength: 1.9,
    fill: '#b9c2d8',
    fill_strength: 0.6,
    soil: '#cbb698',
    lunar: 0.7,
    surge: 0.4,
    shadow_fill: 0.3,
    companion: 'charon',
  },
};

/** Returns the look of a body; custom gravity has no body, and looks like the Moon. */
export function lookOf(body: string | null): BodyLook {
  return (body !== null && LOOKS[body]) || MOON;
}
