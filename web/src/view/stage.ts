// The picture: all its objects, and the time of drawing. A frame is drawn only when something changed, so a paused bed
// costs nothing.

import type { ColourMode, Frame, Pose, Robot, Scene, Tool, Vec3 } from 'haptolith-protocol';
import { AmbientLight, Color, DirectionalLight, Group, HemisphereLight, Scene as World, Vector3 } from 'three';
import { movedWith } from '../hand/pose_math';
import { h } from '../panels/html';
import type { Drawing, ViewName } from '../settings';
import { ArrowsView } from './arrows';
import { BedView } from './bed_view';
import { lookOf } from './body_looks';
import { BoxView } from './box_view';
import { OrbitCamera } from './camera';
import { GroundView } from './ground_view';
import { lightBody, makeLightUniforms, needNoise, shadeTool, shadeToolAt, LOW_SUN, TO_SUN } from './light_shader';
import { makeRenderer, type Renderer } from './renderer';
import { Pace } from './pace';
import { Resolution } from './resolution';
import { RobotView } from './robot_view';
import { SiteView } from './site_view';
import { SkyView } from './sky_view';
import { StoneView } from './stone_view';
import { ToolView } from './tool_view';

const HIGHEST_PIXEL_RATIO = 2;
// Closer to the edge, an object counts as cut off. The edges are at -1 and 1.
const IN_PICTURE = 0.85;
const NO_PICTURE =
  'No picture: this browser shows no WebGL 2. Numbers, plots and controls work without it. To see the bed, switch on ' +
  "graphics acceleration in the browser's settings, or open this address in a current Chrome, Edge, Firefox or Safari.";

const screenRatio = (): number => Math.min(HIGHEST_PIXEL_RATIO, window.devicePixelRatio);

export interface StageOptions {
  reduced_motion: boolean;
  /** always full resolution, for pictures */
  full_quality: boolean;
  /** hides all hints at the rendered force, the soil and the world: no arrows, and every body as the Moon */
  neutral?: boolean;
}

export class Stage {
  readonly renderer: Renderer;
  /** false: the browser has no WebGL 2, and the picture stays empty */
  readonly draws: boolean;
  /** rendering in software, by the processor, which has other work */
  readonly software: boolean;
  readonly world = new World();
  /** contains everything in the scene's frame; a headset's table moves and scales it */
  readonly bench = new Group();
  readonly orbit = new OrbitCamera();
  readonly bed: BedView;
  readonly ground: GroundView;
  readonly sky: SkyView;
  readonly box = new BoxView();
  /** the tool of this page */
  readonly tool = new ToolView();
  readonly robot = new RobotView();
  readonly site = new SiteView();
  readonly stones: StoneView;
  readonly arrows = new ArrowsView();
  /** number of the tool of this page */
  own = 0;
  frames_drawn = 0;
  /** false: nothing is drawn for now */
  shown = true;
  /** element that covers the top of the picture */
  over: HTMLElement | null = null;
  /** area of the picture of a robot's site */
  site_window: HTMLElement | null = null;
  /** called at the screen's refresh rate, for input */
  onTick: (now_ms: number) => void = () => {};
  /** called when a frame may be drawn: other parts of the page update here, which costs least */
  onDue: (now_ms: number) => void = () => {};
  onDrawn: () => void = () => {};

  private readonly light = makeLightUniforms();
  private drawing: Drawing = 'balls';
  private readonly sun = new DirectionalLight(0xffffff, 2);
  private readonly fill = new HemisphereLight(0xffffff, 0x555555, 1);
  private readonly resolution: Resolution;
  private readonly pace: Pace;
  private scene: Scene | null = null;
  private frame: Frame | null = null;
  /** the other tools, in their order */
  private readonly others: ToolView[] = [];
  private dirty = true;
  /** a frame with soil has been drawn */
  private begun = false;
  private neutral: boolean;
  private given: Scene | null = null;

  constructor(
    private readonly host: HTMLElement,
    private readonly options: StageOptions,
  ) {
    this.neutral = options.neutral ?? false;
    const { renderer, draws, software } = makeRenderer(options.full_quality);
    [this.renderer, this.draws, this.software] = [renderer, draws, software];
    this.renderer.domElement.className = 'stage-canvas';
    host.append(this.renderer.domElement);
    this.renderer.domElement.setAttribute('role', 'img');
    this.describe('The bed');
    if (!this.draws) host.append(h('p', { class: 'no-picture', role: 'note' }, NO_PICTURE));
    this.resolution = new Resolution(screenRatio(), !options.full_quality, software);
    this.watchScreen();
    this.pace = new Pace(software);
    this.renderer.setPixelRatio(this.resolution.ratio);
    this.renderer.setClearColor(new Color('#000000'));

    this.bed = new BedView(this.light, this.renderer.extensions.has('EXT_conservative_depth'));
    this.ground = new GroundView(this.light);
    this.stones = new StoneView(this.light);
    this.sky = new SkyView(this.light.u_to_sun.value);
    this.setDrawing('grains');
    this.setDetail(this.resolution.detailed);
    this.fill.position.set(0, 0, 1);
    this.bench.add(this.sky.mesh, this.ground.mesh, this.bed.soil.group, this.bed.mesh, this.stones.group);
    this.bench.add(this.box.group, this.tool.group, this.robot.group);
    if (!options.neutral) this.bench.add(this.tool.ghost, this.arrows.group);
    this.bench.add(this.sun, this.sun.target, this.fill, new AmbientLight(0xffffff, 0.15));
    this.world.add(this.bench);

    new ResizeObserver(() => this.resize()).observe(host);
    this.resize();
  }

  /** Describes the picture for screen readers. */
  describe(text: string): void {
    this.renderer.domElement.setAttribute('aria-label', text);
  }

  start(): void {
    this.renderer.setAnimationLoop((now_ms: number) => this.draw(now_ms));
  }

  invalidate(): void {
    this.dirty = true;
  }

  /** Applies a scene whose `tool` is the tool of this page, and has this number in `tools`. */
  setScene(given: Scene, own = 0): void {
    this.given = given;
    this.own = own;
    const scene = this.neutral ? { ...given, body: 'Moon' } : given;
    this.scene = scene;
    this.bed.setScene(scene);
    this.setDetail(this.resolution.detailed);
    this.ground.setScene(scene);
    this.box.setScene(scene, this.bed.reach_m);
    this.tool.setTool(scene.tool);
    this.setOthers(scene);
    this.robot.setTool(scene.tools?.[0] ?? scene.tool);
    this.site.setScene(scene, this.neutral);
    this.stones.setScene(scene);
    this.arrows.setScene(scene);
    this.sky.setBody(scene.body);
    lightBody(this.light, scene.body);
    shadeTool(this.light, scene.tool);
    const look = lookOf(scene.body);
    this.sun.color.set(look.sun);
    this.sun.intensity = 1.1 * look.sun_strength;
    this.fill.color.set(look.fill);
    this.fill.groundColor.set(look.soil).multiplyScalar(0.5);
    this.fill.intensity = 1.3 * look.fill_strength;
    this.orbit.setScene(scene);
    this.dirty = true;
  }

  /** Sets whether every body looks like the Moon. */
  setNeutral(neutral: boolean): void {
    if (neutral === this.neutral) return;
    this.neutral = neutral;
    if (this.given) this.setScene(this.given, this.own);
  }

  setFrame(frame: Frame, held: boolean): void {
    if (!this.scene || !this.bed.setFrame(frame, this.own)) return;
    this.frame = frame;
    if (frame.whole) this.box.setScene(this.scene, this.bed.reach_m);
    const turned = frame.tools[this.own]?.turned ?? frame.tool;
    this.tool.setPoses(turned, movedWith(turned, frame.tool, frame.wished), held, frame.opening_m);
    const other_states = frame.tools.filter((_, i) => i !== this.own);
    this.others.forEach((view, i) => {
      const state = other_states[i];
      view.group.visible = state !== undefined;
      if (state) view.setPoses(state.turned, state.wished, false, state.opening_m);
    });
    if (this.stones.setFrame(frame)) this.bed.outdateField();
    shadeToolAt(this.light, this.scene.tool, turned, frame.opening_m);
    this.arrows.setFrame(frame, held);
    this.dirty = true;
  }

  /** Sets the last report of a remote robot; null: no robot. */
  setRobot(robot: Robot | null): void {
    const shown = this.robot.group.visible;
    const now_ms = performance.now();
    this.robot.setRobot(robot, now_ms);
    if (this.site.setRobot(robot, now_ms) || this.robot.group.visible || shown) this.dirty = true;
  }

  setColour(mode: ColourMode): void {
    this.bed.setColour(mode);
    this.dirty = true;
  }

  /** `grains`: realistic soil, in the ground. `balls`: the simulated particles, in a box on the ground. */
  setDrawing(drawing: Drawing): void {
    if (drawing === this.drawing) return;
    this.drawing = drawing;
    const balls = drawing === 'balls';
    this.ground.mesh.visible = this.box.group.visible = balls;
    // Low light shows the relief of soil; spheres are clearer in higher light.
    this.light.u_to_sun.value.copy(balls ? TO_SUN : LOW_SUN);
    this.sun.position.copy(this.light.u_to_sun.value);
    this.bed.setDrawing(drawing);
    if (balls) needNoise(this.light);
    this.orbit.setInGround(!balls);
    this.dirty = true;
  }

  /** Sets the radius at which the ground ends, in widths of the box; null: at the horizon. */
  setEdge(widths: number | null): void {
    this.ground.setEdge(widths);
    this.bed.soil.setEdge(widths);
    this.sky.setAround(widths !== null);
  }

  setView(name: ViewName, animate = true): void {
    this.orbit.setView(name, animate && !this.options.reduced_motion);
    this.dirty = true;
  }

  resetView(): void {
    this.orbit.resetView(!this.options.reduced_motion);
    this.dirty = true;
  }

  get currentScene(): Scene | null {
    return this.scene;
  }

  get currentFrame(): Frame | null {
    return this.frame;
  }

  /** Returns every tool and its pose, by number. */
  get tools(): { tool: Tool; pose: Pose; held_by: number }[] {
    const { scene, frame } = this;
    if (!scene || !frame) return [];
    const all = (scene.tools ?? []).flatMap((tool, i) => {
      const state = frame.tools[i];
      return state ? [{ tool, pose: state.hub, held_by: state.held_by }] : [];
    });
    return all.length > 0 ? all : [{ tool: scene.tool, pose: frame.tool, held_by: 0 }];
  }

  /** Returns the position of the tool in the page, in CSS pixels. */
  toolOnScreen(): { x: number; y: number } | null {
    return this.frame && this.onScreen(this.frame.tool.position_m);
  }

  /** Returns the position of a point of the scene in the page, in CSS pixels. */
  onScreen(at_m: Vec3): { x: number; y: number } {
    const at = new Vector3(...at_m).project(this.orbit.camera);
    const rect = this.renderer.domElement.getBoundingClientRect();
    return { x: rect.left + ((at.x + 1) / 2) * rect.width, y: rect.top + ((1 - at.y) / 2) * rect.height };
  }

  isInPicture(at_m: Vec3): boolean {
    const at = new Vector3(...at_m).project(this.orbit.camera);
    return Math.abs(at.x) < IN_PICTURE && Math.abs(at.y) < IN_PICTURE && at.z < 1;
  }

  /** Evaluates the loop's state in a status: the page draws less often before the loop suffers. */
  watchLoop({ ticks, misses }: { ticks: number; misses: number }): void {
    this.pace.watchLoop(ticks, misses);
  }

  /** Fits the picture to the page again, after use by a headset or a change of the covering element. */
  refit(): void {
    this.resize();
  }

  private setOthers({ tools = [] }: Scene): void {
    const others = tools.filter((_, i) => i !== this.own);
    for (const view of this.others.splice(others.length)) {
      this.bench.remove(view.group);
      view.dispose();
    }
    others.forEach((tool, i) => {
      if (!this.others[i]) {
        const view = new ToolView();
        view.setDetail(this.resolution.detailed);
        view.group.visible = false;
        this.others.push(view);
        this.bench.add(view.group);
      }
      this.others[i]!.setTool(tool);
    });
  }

  private drawSite(): void {
    const window = this.site_window?.getBoundingClientRect();
    if (!this.site.visible || !window || window.width < 1 || window.height < 1) return;
    const canvas = this.renderer.domElement.getBoundingClientRect();
    const [x, y] = [window.left - canvas.left, canvas.bottom - window.bottom];
    this.renderer.setScissorTest(true);
    this.renderer.setScissor(x, y, window.width, window.height);
    this.renderer.setViewport(x, y, window.width, window.height);
    this.renderer.render(this.site.world, this.site.cameraBeside(this.orbit.camera, window.width / window.height));
    this.renderer.setScissorTest(false);
    this.renderer.setViewport(0, 0, canvas.width, canvas.height);
  }

  private setDetail(detailed: boolean): void {
    if (detailed || this.drawing === 'balls' || this.scene?.stones?.length) needNoise(this.light);
    for (const tool of [this.tool, ...this.others]) tool.setDetail(detailed);
    this.bed.setDetail(detailed);
    this.ground.setDetail(detailed);
  }

  private resize(): void {
    const width = Math.max(1, this.host.clientWidth);
    const height = Math.max(1, this.host.clientHeight);
    if (this.renderer.xr.isPresenting) return;
    this.renderer.setSize(width, height, false);
    this.orbit.setAspect(width / height, this.coveredShare(width, height));
    this.dirty = true;
  }

  /** Watches the pixel ratio, which changes with the screen or the zoom; a media query is valid for one ratio only. */
  private watchScreen(): void {
    matchMedia(`(resolution: ${window.devicePixelRatio}dppx)`).addEventListener(
      'change',
      () => {
        this.resolution.setScreen(screenRatio());
        this.renderer.setPixelRatio(this.resolution.ratio);
        this.resize();
        this.watchScreen();
      },
      { once: true },
    );
  }

  /** Returns the fraction of the height that is covered above the centre. */
  private coveredShare(width: number, height: number): number {
    if (!this.over?.isConnected) return 0;
    const view = this.host.getBoundingClientRect();
    const over = this.over.getBoundingClientRect();
    const in_the_way = over.left < view.left + 0.55 * width && over.right > view.left + 0.45 * width;
    return in_the_way ? Math.min(0.4, Math.max(0, over.bottom - view.top) / height) : 0;
  }

  private draw(now_ms: number): void {
    this.onTick(now_ms);
    const in_headset = this.renderer.xr.isPresenting;
    if (!in_headset && !this.pace.due(now_ms)) return;
    if (!in_headset && !this.shown) return this.resolution.rest();
    this.onDue(now_ms);
    if (this.orbit.advance(now_ms)) this.dirty = true;
    for (const moving of [this.robot, this.site]) if (moving.advance(now_ms)) this.dirty = true;
    this.pace.drawn(now_ms);
    if (!this.dirty && !in_headset) {
      this.resolution.rest();
      return;
    }
    // A pending field is built with one of the next frames.
    this.dirty = this.bed.refreshField(now_ms, this.stones);
    this.arrows.setPicture(this.orbit.shorterSide_m(in_headset));
    // Compiling a shader takes the processor long, so the first frame contains only soil and tool.
    const first = this.software && this.bed.drawn > 0 && !this.begun;
    this.sky.mesh.visible = !this.software || this.begun;
    this.renderer.render(this.world, this.orbit.camera);
    if (first) this.begun = this.dirty = true;
    if (!in_headset) this.drawSite();
    this.frames_drawn += 1;
    this.onDrawn();
    if (!in_headset && this.resolution.drawn(now_ms, this.pace.interval_ms)) {
      this.renderer.setPixelRatio(this.resolution.ratio);
      this.setDetail(this.resolution.detailed);
      this.resize();
    }
  }
}
