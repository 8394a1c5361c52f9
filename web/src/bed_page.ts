// The page that shows the bed and holds the tool.

import {
  COLOUR_MODES,
  type ColourMode,
  type Command,
  type Frame,
  type Hello,
  isFeltChange,
  type Scene,
  type Status,
} from 'haptolith-protocol';
import { publish } from './automation';
import { Connection, type Program } from './connection';
import { GamepadHand } from './hand/gamepad_hand';
import { Hand } from './hand/hand';
import { KeyHand } from './hand/key_hand';
import { ToolTilt } from './hand/tilt';
import { ToolBringer } from './hand/tool_bringer';
import { PointerHand } from './hand/pointer_hand';
import { VrHand } from './hand/vr_hand';
import { Controls } from './panels/controls';
import { Help } from './panels/help';
import { h, setText } from './panels/html';
import { Layout } from './panels/layout';
import { Legend, ScaleBar } from './panels/legend';
import { Notices } from './panels/notices';
import { Plots } from './panels/plots';
import { pictureInWords, Readouts } from './panels/readouts';
import { SiteCard } from './panels/site_card';
import { StatusStrip } from './panels/status_strip';
import { TiltControl } from './panels/tilt_control';
import { frameOf, nameOf, sceneOf } from './own_tool';
import {
  DRAWINGS,
  rememberColour,
  rememberDrawing,
  rememberTheme,
  VIEW_NAMES,
  type Drawing,
  type Settings,
  type Theme,
} from './settings';
import { askFirst } from './study/dialogs';
import { isTyping, runShortcut, TOOL_KEYS, TOUCH, VIEW_KEYS, type Shortcut } from './shortcuts';
import { SoilSound } from './sound';
import { ToolFiles } from './tool_file';
import { Stage } from './view/stage';

const DESCRIBE_INTERVAL_MS = 1000;
// In software rendering, plots cost as much as a frame of the bed.
const SOFTWARE_PLOTS_MS = 240;
const RECORDING = (run: () => void): Shortcut => ({ keys: ['o'], label: 'record: on or off', group: 'time', run });

/** State and actions that a page with the bed offers to other modules. */
export interface BedPage {
  readonly stage: Stage;
  readonly notices: Notices;
  colour(): ColourMode;
  drawing(): Drawing;
}

/** @param buttons  buttons in the top strip, before its default buttons */
export function openBedPage(settings: Settings, program: Program, buttons: HTMLElement[] = []): BedPage {
  const now = {
    hello: null as Hello | null,
    /** with the tool of this page as its `tool`, as `frame` has it */
    scene: null as Scene | null,
    status: null as Status | null,
    frame: null as Frame | null,
    /** number of the tool of this page */
    own: 0,
    colour: settings.colour,
    drawing: settings.drawing,
    theme: settings.theme,
  };

  /** as the program has sent them */
  const given = { scene: null as Scene | null, frame: null as Frame | null };

  let described_ms = -Infinity;
  let plotted_ms = -Infinity;
  /** the frame of the displayed numbers */
  let shown_frame: Frame | null = null;

  const notices = new Notices(() => connection.retryNow());
  const connection = new Connection(program, {
    hello: onHello,
    scene: onScene,
    status: onStatus,
    frame: onFrame,
    link: onLink,
    damaged: (error) => notices.toast(error instanceof Error ? error.message : String(error)),
  });

  const tell = (command: Command): void => {
    const name = command.do === 'play' && given.scene ? nameOf(given.scene, now.own) : undefined;
    const told = name === undefined ? command : ({ ...command, tool: name } as Command);
    connection.request(told).catch((error: Error) => notices.toast(error.message));
  };
  /** Whether changes while a person holds the device have been confirmed: asked once per holding. */
  let agreed = false;
  const ask = (command: Command): void => {
    if (!isFeltChange(command) || !now.status?.person_feels) return tell(command);
    if (agreed) return tell({ ...command, confirmed: true });
    askFirst(
      {
        title: 'A user is holding the device',
        text: `Changing the soil, gravity or tool changes the force at the device (${now.status.device}). Warn the user first. This question is not repeated until the device is released.`,
        stay: 'Cancel',
        go_on: 'Change',
      },
      () => {
        agreed = true;
        tell({ ...command, confirmed: true });
      },
      () => controls.showAgain(),
    );
  };

  const layout = new Layout(settings.panels);
  const stage = new Stage(layout.view, {
    reduced_motion: matchMedia('(prefers-reduced-motion: reduce)').matches,
    full_quality: settings.for_pictures,
  });
  const hand = new Hand(connection, (error) => notices.toast(error.message), showHolding);
  const force_n = (): number => (now.frame ? Math.hypot(...now.frame.force_n) : 0);
  const box_scale = (): number => (now.scene?.box.width_m ?? 0.126) / 0.126;
  const tilt = new ToolTilt(
    hand,
    () => now.scene,
    () => now.frame,
    () => stage.orbit.right().toArray(),
  );
  const pointer = new PointerHand(stage, hand, stage.renderer.domElement, () => tilt.taken(), chooseTool);
  const keys = new KeyHand(hand, stage.orbit, box_scale);
  const gamepad = new GamepadHand(hand, stage.orbit, box_scale, force_n);
  const bringer = new ToolBringer(
    hand,
    () => now.scene,
    () => tilt.digging,
  );
  const vr = new VrHand(stage, hand, force_n, showVr);

  const strip = new StatusStrip(() => now.hello?.client ?? null, settings.for_pictures, coarsen);
  const tilt_control = new TiltControl((tilt_deg) => tilt.set(tilt_deg));
  const readouts = new Readouts();
  const site_card = new SiteCard();
  stage.over = readouts.element;
  stage.site_window = site_card.window;
  const legend = new Legend();
  const scale_bar = new ScaleBar();
  const plots = new Plots();
  const sound = new SoilSound();
  const tool_files = new ToolFiles({
    upload: (file) => program.upload(file),
    taken: () => now.hello?.takes_uploads === true && connection.connected,
    use: (file) => ask({ do: 'tool_file', ...file }),
    refused: (why) => notices.toast(why),
  });
  const controls = new Controls(
    {
      ask,
      setColour,
      setDrawing,
      setView: (name) => stage.setView(name),
      resetView: () => stage.resetView(),
      setDigAnywhere: (on) => (pointer.dig_anywhere = on),
      setSound,
      bringTool,
      chooseTool,
      chooseToolFile: () => tool_files.choose(),
      recordingAddress: program.recordingAddress,
    },
    settings.for_pictures,
  );

  const shortcuts: Shortcut[] = [
    ...TOUCH,
    ...TOOL_KEYS,
    { keys: ['g'], label: 'drag anywhere to dig: on or off', group: 'tool', run: () => controls.toggleDig() },
    { keys: ['y'], label: 'virtual hand: hold still', group: 'tool', run: () => controls.holdStill() },
    { keys: ['k'], label: 'move the tool above the bed, ready to dig', group: 'tool', run: bringTool },
    { keys: ['m'], label: 'virtual hand: next motion', group: 'tool', run: () => controls.next('motion') },
    { keys: ['x'], label: 'next tool', group: 'tool', run: () => controls.next('shape') },
    ...VIEW_KEYS,
    ...VIEW_NAMES.map((name, i): Shortcut => ({
      keys: [String(i + 1)],
      shown: i === 0 ? '1 2 3 4' : '',
      label: `view: ${VIEW_NAMES.join(', ')}`,
      group: 'view',
      run: () => stage.setView(name),
    })),
    { keys: ['0'], label: 'reset the view', group: 'view', run: () => stage.resetView() },
    { keys: ['+', '='], shown: '+ −', label: 'nearer, farther', group: 'view', run: () => zoom(1.15) },
    { keys: ['-'], shown: '', label: 'farther', group: 'view', run: () => zoom(1 / 1.15) },
    { keys: ['i'], label: 'error band of the force: show or hide', group: 'view', run: () => plots.toggleBand() },
    { keys: ['c'], label: 'next colours', group: 'view', run: nextColour },
    { keys: ['p'], label: 'show soil as grains or as spheres', group: 'view', run: nextDrawing },
    { keys: ['v'], label: 'enter or leave VR', group: 'view', run: toggleVr },
    { keys: ['r'], label: 'reset the scene', group: 'bed', run: () => ask({ do: 'reset' }) },
    { keys: ['l'], label: 'level the surface', group: 'bed', run: () => ask({ do: 'level' }) },
    { keys: ['ctrl+z', 'u'], shown: 'Ctrl+Z  U', label: 'undo', group: 'bed', run: () => ask({ do: 'undo' }) },
    { keys: [']'], shown: '[ ]', label: 'previous or next soil', group: 'bed', run: () => controls.next('soil') },
    { keys: ['['], shown: '', label: 'previous soil', group: 'bed', run: () => controls.next('soil', -1) },
    { keys: ['j'], label: 'coarser particles, for slow machines', group: 'bed', run: coarsen },
    { keys: ['b'], label: 'next body', group: 'bed', run: () => controls.next('body') },
    { keys: ['f'], label: 'next friction model', group: 'bed', run: () => controls.next('friction') },
    { keys: [' '], shown: 'Space', label: 'pause, resume', group: 'time', run: () => controls.togglePause() },
    { keys: ['.'], label: 'one tick, while paused', group: 'time', run: () => controls.stepOnce(1) },
    { keys: [','], label: '100 ticks, while paused', group: 'time', run: () => controls.stepOnce(100) },
    { keys: ['n'], label: 'slow motion: on or off', group: 'time', run: () => controls.toggleSlowMotion() },
    ...(program.recordingAddress ? [RECORDING(() => controls.toggleRecord())] : []),
    {
      keys: ['h'],
      label: 'hide or show the panels',
      group: 'page',
      run: () => layout.showPanels(!layout.panels_shown),
    },
    {
      keys: ['t'],
      label: 'dark or light',
      group: 'page',
      run: () => setTheme(now.theme === 'dark' ? 'light' : 'dark'),
    },
    { keys: ['?'], label: 'show this help', group: 'page', run: () => help.toggle() },
  ];
  const help = new Help(shortcuts, () =>
    now.hello ? `haptolith ${now.hello.version}, protocol ${now.hello.protocol}` : 'haptolith',
  );

  const vr_button = h('button', { type: 'button', class: 'quiet vr', onclick: toggleVr }, 'Enter VR');
  const theme_button = h(
    'button',
    {
      type: 'button',
      class: 'icon-button',
      'aria-label': 'Dark or light',
      title: 'Dark or light (T)',
      onclick: () => setTheme(now.theme === 'dark' ? 'light' : 'dark'),
    },
    '◐',
  );
  const help_button = h(
    'button',
    { type: 'button', class: 'icon-button', 'aria-label': 'Help', title: 'Help (?)', onclick: () => help.toggle() },
    '?',
  );
  const hint = h('div', { class: 'hint' }, 'Drag the tool to dig · drag next to it to rotate the view · ? for help');
  const hint_hidden = settings.for_pictures || !stage.draws;
  hint.hidden = hint_hidden;
  scale_bar.element.hidden = !stage.draws;

  layout.assemble({
    strip: strip.element,
    buttons: [...buttons, vr_button, theme_button, help_button],
    over_view: [
      readouts.element,
      tilt_control.element,
      legend.element,
      site_card.element,
      scale_bar.element,
      hint,
      notices.banner,
      notices.busy,
      notices.toasts,
    ],
    plots: plots.element,
    controls: controls.element,
    dialogs: [help.element, tool_files.overlay],
  });
  setTheme(now.theme, false);
  setColour(now.colour);
  setDrawing(now.drawing);
  stage.setView(settings.view, false);
  showVr();

  addEventListener('keydown', (event) => {
    if (help.element.open) {
      if (event.key === '?') help.toggle();
      return;
    }
    if (event.defaultPrevented || isTyping(event)) return;
    if (keys.down(event) || (!event.repeat && runShortcut(shortcuts, event))) event.preventDefault();
  });
  addEventListener('keyup', (event) => keys.up(event));
  document.addEventListener('visibilitychange', () => {
    if (!document.hidden) connection.retryNow();
  });

  stage.onTick = (now_ms) => {
    keys.tick(now_ms);
    gamepad.tick(now_ms);
    bringer.tick(now_ms);
    tilt.tick(now_ms);
    tilt_control.show(now.hello?.read_only ? null : tilt.now_deg, now_ms);
    vr.tick(now_ms);
    hand.tick(now_ms);
  };
  stage.onDue = (now_ms) => {
    if (!stage.software || now_ms - plotted_ms > SOFTWARE_PLOTS_MS) {
      plots.tick(now_ms);
      plotted_ms = now_ms;
    }
    if (!now.frame || now.frame === shown_frame) return;
    shown_frame = now.frame;
    strip.setTime(now.frame.time_s);
    if (now.scene) readouts.setFrame(now.frame, now.scene, now_ms);
  };
  stage.onDrawn = () => {
    scale_bar.show(stage.orbit.metresPerPixel(stage.renderer.domElement.clientHeight || 1));
  };
  stage.start();
  connection.open();
  publish({ stage, connection, layout, now, setColour, setDrawing, setTheme });
  return { stage, notices, colour: () => now.colour, drawing: () => now.drawing };

  function onHello(hello: Hello): void {
    now.hello = hello;
    pointer.may_dig = !hello.read_only;
    hint.hidden = hint_hidden || hello.read_only;
    controls.setHello(hello);
    plots.clear();
    // The program drops a client's colours with its connection.
    connection.send({ do: 'colour', by: now.colour });
  }

  function onScene(scene: Scene): void {
    const { mesh } = scene.tool;
    if (given.scene && mesh && mesh !== given.scene.tool.mesh && mesh.report.length > 0)
      notices.toast(`${mesh.name}: ${mesh.report.join(' ')}`);
    given.scene = scene;
    if (now.own >= (scene.tools?.length ?? 1)) now.own = 0; // another program
    showScene(sceneOf(scene, now.own));
  }

  /** Makes one of several tools the tool of this page. */
  function chooseTool(tool: number): void {
    if (tool === now.own || !given.scene || !given.frame) return;
    now.own = tool;
    showScene(sceneOf(given.scene, tool));
    onFrame(given.frame);
    showHolders();
  }

  function showHolders(): void {
    controls.setHolders(given.frame?.tools.map(({ held_by }) => held_by) ?? [], now.hello?.client);
  }

  function showScene(scene: Scene): void {
    now.scene = scene;
    stage.setScene(scene, now.own);
    hand.choose(nameOf(scene, now.own));
    if (!now.hello?.read_only) hand.setScene(scene); // the hand needs a scene to hold the tool
    vr.setScene(scene);
    strip.setScene(scene);
    tilt_control.element.hidden =
      scene.tool.shape === 'sphere' || settings.for_pictures || now.hello?.read_only === true;
    controls.setScene(scene, now.own);
    layout.setTitle(scene.title);
    legend.show(now.colour, stage.bed.depthRange_m);
  }

  function onStatus(status: Status): void {
    if (status.problem && status.problem !== now.status?.problem) {
      notices.toast(`The change failed: ${status.problem}`);
    }
    if (status.let_go && status.let_go !== now.status?.let_go) {
      notices.toast(`Safety trip: ${status.let_go}.`);
    }
    agreed &&= status.person_feels;
    now.status = status;
    const own = given.frame?.tools[now.own];
    const held_by = own ? own.held_by || null : status.held_by;
    strip.setStatus({ ...status, held_by });
    stage.watchLoop(status);
    readouts.setRobot(status.robot ?? null);
    site_card.setRobot(status.robot ?? null);
    stage.setRobot(status.robot ?? null);
    controls.setStatus(status);
    describe();
    notices.setBusy(status.busy);
    // A pause, or another hand, takes the tool from this hand.
    if (status.paused || (held_by !== null && held_by !== now.hello?.client)) hand.giveUp();
    showHolders();
  }

  /** Describes the picture. At most once a second, because it is read aloud. */
  function describe(): void {
    const { scene, frame } = now;
    if (!scene || !frame || performance.now() - described_ms < DESCRIBE_INTERVAL_MS) return;
    described_ms = performance.now();
    stage.describe(pictureInWords(scene, frame));
  }

  function onFrame(given_frame: Frame): void {
    given.frame = given_frame;
    const frame = frameOf(given_frame, now.own);
    now.frame = frame;
    hand.setFrame(frame);
    stage.setFrame(frame, frame.held);
    plots.setFrame(frame);
    sound.setFrame(frame);
  }

  function onLink(connected: boolean, why: string | null): void {
    notices.setLink(connected, why);
    controls.setConnected(connected);
    strip.setConnected(connected);
    if (!connected) readouts.clear();
    if (!connected) {
      notices.setBusy(null);
      hand.drop();
    }
  }

  function setColour(mode: ColourMode): void {
    now.colour = mode;
    rememberColour(mode);
    stage.setColour(mode);
    controls.setColour(mode);
    legend.show(mode, stage.bed.depthRange_m);
    connection.send({ do: 'colour', by: mode });
  }

  function nextColour(): void {
    setColour(COLOUR_MODES[(COLOUR_MODES.indexOf(now.colour) + 1) % COLOUR_MODES.length]!);
  }

  function setDrawing(drawing: Drawing): void {
    now.drawing = drawing;
    rememberDrawing(drawing);
    stage.setDrawing(drawing);
    controls.setDrawing(drawing);
  }

  function setSound(on: boolean): boolean {
    const plays = sound.setOn(on);
    if (!plays) notices.toast('No sound: this browser does not support it.');
    return plays;
  }

  function nextDrawing(): void {
    setDrawing(DRAWINGS[(DRAWINGS.indexOf(now.drawing) + 1) % DRAWINGS.length]!);
  }

  function setTheme(theme: Theme, remember = true): void {
    now.theme = theme;
    document.documentElement.dataset.theme = theme;
    if (remember) rememberTheme(theme);
    plots.restyle();
  }

  function zoom(factor: number): void {
    stage.orbit.zoomBy(factor);
    stage.invalidate();
  }

  function bringTool(): void {
    if (now.hello?.read_only || !bringer.start()) return;
    // The view may have been turned away from there.
    if (!stage.isInPicture(bringer.target_m!)) stage.resetView();
  }

  function coarsen(): void {
    if (now.scene?.can_coarsen) ask({ do: 'coarser' });
  }

  function toggleVr(): void {
    if (vr.unavailable) return notices.toast(`VR is not available: ${vr.unavailable}.`);
    vr.toggle().catch((error: unknown) =>
      notices.toast(`VR did not start: ${error instanceof Error ? error.message : String(error)}`),
    );
  }

  function showVr(): void {
    setText(vr_button, vr.active ? 'Leave VR' : 'Enter VR');
    vr_button.disabled = vr.unavailable !== null;
    vr_button.title = vr.unavailable ? `VR is not available: ${vr.unavailable}` : 'Enter or leave VR (V)';
  }

  function showHolding(): void {
    if (hand.held) hint.classList.add('gone');
    stage.invalidate();
  }
}
