// window.haptolith: state and controls for tests and `haptolith snapshot`.

import type { ColourMode, Frame, FrameHeader, Scene, Status } from 'haptolith-protocol';
import type { Layout } from './panels/layout';
import type { Drawing, Theme, ViewName } from './settings';
import type { Stage } from './view/stage';

export interface Automation {
  /** the first picture with particles has been drawn */
  readonly ready: boolean;
  readonly scene: Scene | null;
  readonly status: Status | null;
  /** header and tools of the last frame */
  readonly frame: (FrameHeader & Pick<Frame, 'tools'>) | null;
  /** time of the displayed frame, which a study may delay */
  readonly seen_s: number | null;
  readonly client: number | null;
  /** a connection to the program is open */
  readonly connected: boolean;
  readonly particlesDrawn: number;
  readonly framesDrawn: number;
  /** position of the tool, in CSS pixels of the page */
  readonly toolOnScreen: { x: number; y: number } | null;
  /** position of the centre of the bed's surface, in CSS pixels of the page */
  readonly bedOnScreen: { x: number; y: number } | null;
  readonly inHeadset: boolean;
  setCamera(name: ViewName): void;
  setColour(mode: ColourMode): void;
  setDrawing(drawing: Drawing): void;
  setTheme(theme: Theme): void;
  hidePanels(hide: boolean): void;
  /** false: nothing is drawn for now, which leaves the processor to the loop */
  drawPicture(draw: boolean): void;
}

declare global {
  interface Window {
    haptolith?: Automation;
  }
}

interface Parts {
  stage: Stage;
  connection: { readonly connected: boolean };
  /** absent: no panels to hide */
  layout?: Layout;
  now: { hello: { client: number } | null; scene: Scene | null; status: Status | null; frame: Frame | null };
  setColour(mode: ColourMode): void;
  setDrawing(drawing: Drawing): void;
  setTheme(theme: Theme): void;
}

export function publish({ stage, connection, layout, now, setColour, setDrawing, setTheme }: Parts): void {
  let ready = false;
  const drawn = stage.onDrawn;
  stage.onDrawn = () => {
    drawn();
    if (stage.draws && stage.bed.drawn > 0) ready = true;
  };
  window.haptolith = {
    get ready() {
      return ready;
    },
    get scene() {
      return now.scene;
    },
    get status() {
      return now.status;
    },
    get frame() {
      if (!now.frame) return null;
      const { runs: _runs, records: _records, ...header } = now.frame;
      return header;
    },
    get seen_s() {
      return stage.currentFrame?.time_s ?? null;
    },
    get client() {
      return now.hello?.client ?? null;
    },
    get connected() {
      return connection.connected;
    },
    get particlesDrawn() {
      return stage.bed.drawn;
    },
    get framesDrawn() {
      return stage.frames_drawn;
    },
    get toolOnScreen() {
      return stage.toolOnScreen();
    },
    get bedOnScreen() {
      return now.scene && stage.onScreen([0, 0, now.scene.box.surface_m]);
    },
    get inHeadset() {
      return stage.renderer.xr.isPresenting;
    },
    setCamera: (name) => stage.setView(name, false),
    setColour,
    setDrawing,
    setTheme: (theme) => setTheme(theme),
    hidePanels: (hide) => layout?.showPanels(!hide),
    drawPicture: (draw) => (stage.shown = draw),
  };
}
