// The renderer: WebGL 2, or nothing where the browser does not support it. Numbers, plots and controls need no picture,
// so the page continues without one and shows a note in its place.

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

interface Made {
  renderer: Renderer;
  /** false: the browser has no WebGL 2 */
  draws: boolean;
  /** rendering in software, by the processor */
  software: boolean;
}

/** Makes a WebGL 2 renderer if possible; otherwise one that keeps the page's animation loop and draws nothing. */
export function makeRenderer(full_quality: boolean): Made {
  try {
    const canvas = full_quality ? null : canvasInSoftware();
    // WebGLRenderer takes the context that the canvas already has.
    const renderer = canvas
      ? new WebGLRenderer({ canvas, antialias: false })
      : new WebGLRenderer({ antialias: true, powerPreference: 'high-performance' });
    return { renderer, draws: true, software: canvas !== null };
  } catch {
    return { renderer: new NoRenderer() as unknown as Renderer, draws: false, software: false };
  }
}

/** Returns a canvas with a context for software rendering; a second context would take longer. */
function canvasInSoftware(): HTMLCanvasElement | null {
  const canvas = document.createElement('canvas');
  const gl = canvas.getContext('webgl2', { alpha: false, antialias: false });
  const info = gl?.getExtension('WEBGL_debug_renderer_info');
  const name = gl && info ? String(gl.getParameter(info.UNMASKED_RENDERER_WEBGL)) : '';
  if (/swiftshader|llvmpipe|softpipe|software|basic render/i.test(name)) return canvas;
  gl?.getExtension('WEBGL_lose_context')?.loseContext();
  return null;
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
