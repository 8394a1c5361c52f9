// What draws: WebGL 2, or nothing where the browser has none. Numbers, plots and controls need no picture, so the page
// goes on without one and says so in its place.

import { WebGLRenderer } from 'three';

export type Renderer = Pick<
  WebGLRenderer,
  | 'domElement'
  | 'xr'
  | 'setPixelRatio'
  | 'setSize'
  | 'setClearColor'
  | 'setAnimationLoop'
  | 'render'
  | 'setScissorTest'
  | 'setScissor'
  | 'setViewport'
> & { extensions: { has(name: string): boolean } };

/** WebGL 2 where there is any; else what keeps the page's beat and draws nothing. */
export function makeRenderer(antialias: boolean): { renderer: Renderer; draws: boolean } {
  try {
    return { renderer: new WebGLRenderer({ antialias, powerPreference: 'high-performance' }), draws: true };
  } catch {
    return { renderer: new NoRenderer() as unknown as Renderer, draws: false };
  }
}

class NoRenderer {
  readonly domElement = document.createElement('canvas');
  readonly extensions = { has: () => false };
  readonly xr = { isPresenting: false, enabled: false, getSession: () => null };
  private run: ((now_ms: number) => void) | null = null;

  setAnimationLoop(run: ((now_ms: number) => void) | null): void {
    const idle = this.run === null;
    this.run = run;
    if (run && idle) requestAnimationFrame((now_ms) => this.beat(now_ms));
  }

  setPixelRatio(): void {}
  setSize(): void {}
  setClearColor(): void {}
  render(): void {}
  setScissorTest(): void {}
  setScissor(): void {}
  setViewport(): void {}

  private beat(now_ms: number): void {
    this.run?.(now_ms);
    if (this.run) requestAnimationFrame((next_ms) => this.beat(next_ms));
  }
}
