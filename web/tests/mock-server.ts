// A mock of `haptolith run` for the development of the page, and for browser tests without a program: serves web/dist
// and implements docs/reference/web-protocol.md.

import {
  type Command,
  type Hello,
  isFeltChange,
  type MeshText,
  type NamedTool,
  type Pose,
  type Robot,
  type Scene,
  type SceneChange,
  type Status,
  Stone,
  ToolMesh,
  type ToolState,
  type Vec3,
} from 'haptolith-protocol';
import { createReadStream, existsSync } from 'node:fs';
import { createServer, type Server } from 'node:http';
import { extname, join, normalize } from 'node:path';
import { fileURLToPath } from 'node:url';
import { parse, type InferInput } from 'valibot';
import { WebSocketServer, type WebSocket } from 'ws';
import { shapeOf, TOOL_SHAPES } from '../src/tool_shapes';
import { encodeFrame, type RecordValues } from './frame-bytes';
import { MockBed } from './mock-bed';
import { MockStudy } from './mock-study';
import { SCOOP } from './scoop';

const DIST = fileURLToPath(new URL('../dist', import.meta.url));
const TYPES: Record<string, string> = {
  '.html': 'text/html; charset=utf-8',
  '.js': 'text/javascript; charset=utf-8',
  '.css': 'text/css; charset=utf-8',
  '.svg': 'image/svg+xml',
};
const POLICY = "default-src 'self'; style-src 'self' 'unsafe-inline'; img-src 'self' data: blob:; connect-src 'self'";
const FRAME_MS = 16;
const STATUS_MS = 250;
const STUDY_MS = 100;
const BODIES: Record<string, number> = {
  Ceres: 0.27,
  Pluto: 0.62,
  Europa: 1.315,
  Moon: 1.625,
  Mars: 3.72,
  Earth: 9.81,
};
const PRESETS: [string, number][] = [
  ['P1', 1.21],
  ['P2', 1],
  ['P3', 0.835],
  ['P4', 0.735],
  ['P5', 0.648],
  ['P6', 0.6],
];
const SOILS: Hello['soils'] = [
  { name: 'apollo-15-srp', source: 'Apollo 15', friction_angle_deg: 49.5, cohesion_pa: 1000, bulk_density_kg_m3: 1970 },
  { name: 'dry-sand', source: 'measured', friction_angle_deg: 29, cohesion_pa: 0, bulk_density_kg_m3: 1330 },
  { name: 'lunar-0-15cm', source: 'Sourcebook', friction_angle_deg: 42, cohesion_pa: 520, bulk_density_kg_m3: 1500 },
];

export interface MockOptions {
  port?: number;
  /** width of the box, in m, and layers of particles of 7 mm diameter */
  width_m?: number;
  layers?: number;
  read_only?: boolean;
  /** a person's hand is at a device */
  person_feels?: boolean;
  /** one tick in ten is late; `others`: because other programs take the processor */
  late?: 'soil' | 'others';
  /** as in a status: a remote robot that follows the tool */
  robot?: Robot;
  /** token that the address of the WebSocket must contain */
  token?: string;
  /** a tool from a mesh file */
  mesh?: MeshText;
  /** two tools, `left` and `right` */
  two_tools?: boolean;
  /** each as in a message, and its pose */
  stones?: { text: InferInput<typeof Stone>; pose: Pose }[];
  /** absent: no study is running */
  study?: MockStudy;
}

interface Client {
  number: number;
  socket: WebSocket;
  needs_whole: boolean;
}

const START_POSE: Pose = { position_m: [-0.01, 0, 0.085], rotation: [0.9659, 0, 0.2588, 0] };

export class MockServer {
  private readonly http: Server;
  private readonly sockets: WebSocketServer;
  private readonly clients: Client[] = [];
  private readonly timers: NodeJS.Timeout[] = [];
  private bed: MockBed;
  private tool: Pose = structuredClone(START_POSE);
  private wished: Pose = structuredClone(START_POSE);
  private holder: number | null = null;
  private readonly right = { pose: { ...START_POSE, position_m: [0.05, 0.03, 0.085] } as Pose, holder: 0 };
  private next_client = 1;
  private uploads = 0;
  private time_s = 0;
  private frame_number = 0;
  private misses = 0;
  private paused = false;
  private speed = 1;
  private busy: string | null = null;
  private undo: (() => void) | null = null;
  private undo_name: string | null = null;
  private recording: string | null = null;
  private recorded: Status['recorded'] = null;
  private scene: Scene;
  private mesh: MeshText | undefined;

  constructor(private readonly options: MockOptions = {}) {
    this.mesh = options.mesh;
    this.bed = this.makeBed();
    this.scene = this.startScene();
    this.http = createServer((request, response) => {
      const path = normalize((request.url ?? '/').split('?')[0]!);
      if (path === '/ws') return void response.writeHead(this.knowsToken(request.url) ? 426 : 401).end();
      if (path.startsWith('/recordings/')) {
        const there = path === `/recordings/${this.recorded?.file}`;
        return void response.writeHead(!this.knowsToken(request.url) ? 401 : there ? 200 : 404).end('recorded');
      }
      if (path === '/upload' && request.method === 'PUT') {
        request.resume();
        return void request.on('end', () => response.end(JSON.stringify({ upload: ++this.uploads })));
      }
      const file = join(DIST, path === '/' ? 'index.html' : path);
      if (!file.startsWith(DIST) || !existsSync(file)) return void response.writeHead(404).end();
      response.writeHead(200, {
        'content-type': TYPES[extname(file)] ?? 'application/octet-stream',
        'content-security-policy': POLICY,
      });
      createReadStream(file).pipe(response);
    });
    this.sockets = new WebSocketServer({
      server: this.http,
      path: '/ws',
      maxPayload: 16384,
      verifyClient: ({ req }, done) => done(this.knowsToken(req.url), 401),
      handleProtocols: (protocols) => (protocols.has('haptolith.1') ? 'haptolith.1' : false),
    });
    this.sockets.on('connection', (socket) => this.welcome(socket));
  }

  async listen(): Promise<number> {
    await new Promise<void>((resolve) => this.http.listen(this.options.port ?? 0, '127.0.0.1', resolve));
    this.timers.push(setInterval(() => this.tick(), FRAME_MS));
    this.timers.push(setInterval(() => this.sendAll(this.status()), STATUS_MS));
    this.timers.push(setInterval(() => this.sendStudy(), STUDY_MS));
    return (this.http.address() as { port: number }).port;
  }

  async close(): Promise<void> {
    this.timers.forEach(clearInterval);
    for (const { socket } of this.clients) socket.terminate();
    this.sockets.close();
    this.http.closeAllConnections();
    await new Promise((resolve) => this.http.close(resolve));
  }

  private knowsToken(url = ''): boolean {
    const { token } = this.options;
    return token === undefined || new URL(url, 'http://localhost').searchParams.get('token') === token;
  }

  private makeBed(): MockBed {
    return new MockBed(this.options.width_m ?? 0.126, 0.007, this.options.layers ?? 4);
  }

  private startScene(): Scene {
    const scene = this.startSceneOfOne();
    const named = (name: string): NamedTool => ({ name, motion: 'still', ...scene.tool });
    return this.options.two_tools ? { ...scene, tools: [named('left'), named('right')] } : scene;
  }

  private startSceneOfOne(): Scene {
    const width_m = this.options.width_m ?? 0.126;
    const far = Math.max(0.2, width_m);
    return {
      type: 'scene',
      scene: 1,
      title: 'The scene of the ICRA 2021 paper',
      particles: this.bed.count,
      radius_m: 0.007,
      can_coarsen: true,
      size_spread: 0,
      box: {
        width_m,
        length_m: width_m,
        surface_m: 0.007 * (2 + 1.5 * ((this.options.layers ?? 4) - 1)),
        periodic_x: false,
        periodic_y: false,
      },
      quantised: { low_m: [-far, -far, -0.02], high_m: [far, far, 0.5] },
      soil: {
        preset: 'P3',
        name: null,
        friction: 'icra2021',
        friction_angle_deg: 39.9,
        cohesion_pa: 996,
        bulk_density_kg_m3: 1330,
      },
      sliders: [
        { key: 'friction_angle_deg', label: 'friction angle', unit: '°', value: 39.9, low: 1, high: 70, step: 0.5 },
        { key: 'cohesion_pa', label: 'cohesion', unit: 'Pa', value: 996, low: 10, high: 3000, step: 10 },
      ],
      body: 'Moon',
      gravity_m_s2: [0, 0, -1.625],
      tool: {
        shape: 'box',
        size_mm: [50, 40, 5],
        diameter_mm: 60,
        thickness_mm: 5,
        length_mm: 150,
        opening_mm: 60,
        jaw_bend_deg: 0,
        mesh: this.options.mesh ? parse(ToolMesh, this.options.mesh) : null,
      },
      stones: this.options.stones?.map(({ text }) => parse(Stone, text)),
      hand: { motion: 'still', max_force_n: 12, max_torque_nm: 0.2 },
      workspace: { low_m: [-far, -far, 0], high_m: [far, far, 0.4] },
    };
  }

  private hello(client: number): Hello {
    return {
      type: 'hello',
      protocol: 1,
      version: '0.2.0',
      client,
      read_only: this.options.read_only ?? false,
      takes_uploads: !this.options.read_only,
      presets: PRESETS.map(([name, friction_coefficient]) => ({ name, friction_coefficient })),
      soils: SOILS,
      bodies: Object.entries(BODIES).map(([name, gravity_m_s2]) => ({ name, gravity_m_s2 })),
      frictions: ['icra2021', 'contact'],
      shapes: Object.keys(TOOL_SHAPES) as Hello['shapes'],
      motions: ['still', 'press', 'stir', 'scoop', 'carry', 'shake', 'cut', 'furrows'],
    };
  }

  private status(): Status {
    return {
      type: 'status',
      time_s: this.time_s,
      ticks: Math.round(this.time_s * 1000),
      misses: this.misses,
      misses_too_long: this.misses,
      misses_woken_late: 0,
      misses_preempted: 0,
      success_rate: 0.99,
      rate_hz: this.paused ? 0 : 1000 * this.speed,
      tick_us: { p50: 7.1, p99: 36.2, max: 1989.9 },
      particles: this.bed.count,
      awake: this.bed.awake,
      paused: this.paused,
      speed: this.speed,
      held_by: this.holder,
      clients: this.clients.length,
      device: this.options.person_feels ? 'a handle' : 'virtual hand',
      person_feels: this.options.person_feels ?? false,
      let_go: null,
      real_time: { scheduler: 'SCHED_FIFO', memory_locked: true },
      simd: 'AVX3',
      threads: 1,
      busy: this.busy,
      problem: null,
      can_undo: this.undo !== null,
      undo: this.undo_name,
      undo_redoes: false,
      recording: this.recording,
      recorded: this.recorded,
      robot: this.options.robot ?? null,
      ...this.late(),
    };
  }

  /** Coarser soil is in time. */
  private late(): Partial<Status> {
    if (!this.options.late || this.scene.radius_m > 0.007) return {};
    const misses = Math.round(this.time_s * 100);
    const woken_late = this.options.late === 'others' ? misses : 0;
    return { misses, misses_too_long: misses - woken_late, misses_woken_late: woken_late };
  }

  private welcome(socket: WebSocket): void {
    const client: Client = { number: this.next_client++, socket, needs_whole: true };
    this.clients.push(client);
    socket.on('close', () => {
      this.clients.splice(this.clients.indexOf(client), 1);
      if (this.holder === client.number) this.holder = null;
      if (this.right.holder === client.number) this.right.holder = 0;
      this.options.study?.left(client.number);
    });
    socket.on('message', (data) => this.receive(client, String(data)));
    socket.send(JSON.stringify(this.hello(client.number)));
    socket.send(this.textOf(this.scene));
  }

  private receive(client: Client, text: string): void {
    const command = JSON.parse(text) as Command & { id?: number };
    const error = this.carryOut(client, command);
    if (command.id === undefined) return;
    const reply = { type: 'reply', id: command.id, ok: error === null, ...(error === null ? {} : { error }) };
    client.socket.send(JSON.stringify(reply));
  }

  private carryOut(client: Client, command: Command): string | null {
    const { study } = this.options;
    if (command.do === 'study') {
      const refused = study ? study.obey(client.number, command) : 'no study is running';
      this.sendStudy();
      return refused;
    }
    const refused = study?.refuse(client.number, command) ?? null;
    if (refused !== null) return refused;
    if (this.options.read_only && command.do !== 'colour') return 'view only: the program was started with --read-only';
    if (isFeltChange(command) && this.options.person_feels && !command.confirmed)
      return 'not confirmed: a user holds the haptic device (a handle); confirm the change';
    if ((command.do === 'hold' || command.do === 'release') && command.tool === 'right') {
      const { holder } = this.right;
      if (command.do === 'release') this.right.holder = holder === client.number ? 0 : holder;
      else if (holder !== 0 && holder !== client.number) return 'another client controls the tool';
      else {
        const [x, y, z, ...rotation] = command.pose;
        Object.assign(this.right, { pose: { position_m: [x, y, z], rotation }, holder: client.number });
      }
      return null;
    }
    switch (command.do) {
      case 'hold': {
        if (this.paused) return 'the program is paused';
        if (this.holder !== null && this.holder !== client.number) return `client ${this.holder} holds the tool`;
        const [x, y, z, ...rotation] = command.pose;
        this.holder = client.number;
        this.wished = { position_m: [x, y, z], rotation };
        return null;
      }
      case 'tool_file': {
        if (command.upload !== this.uploads) return 'upload it again';
        this.mesh = { ...SCOOP, name: command.name, report: ['Closed 1 hole.'] };
        this.scene.tool = { ...this.scene.tool, shape: 'mesh', mesh: parse(ToolMesh, this.mesh) };
        return this.sendScene();
      }
      case 'release':
        if (this.holder === client.number) this.holder = null;
        return null;
      case 'play':
        this.scene.hand.motion = command.motion;
        this.holder = null;
        return this.sendScene();
      case 'scene':
        return this.change(command);
      case 'reset': {
        const before = this.scene;
        const bed = this.bed;
        this.remember('reset', () => this.exchange(before, bed));
        this.tool = structuredClone(START_POSE);
        this.wished = structuredClone(START_POSE);
        return this.exchange({ ...this.startScene(), scene: before.scene }, this.makeBed());
      }
      case 'level': {
        const bed = this.bed;
        const scene = this.scene;
        this.remember('level', () => this.exchange(scene, bed));
        return this.exchange(this.scene, this.makeBed());
      }
      case 'coarser': {
        const bed = this.bed;
        const scene = this.scene;
        this.remember('coarser', () => this.exchange(scene, bed));
        return this.exchange({ ...scene, radius_m: 1.1 * scene.radius_m }, this.makeBed());
      }
      case 'undo':
        if (!this.undo) return 'there is nothing to undo';
        this.undo();
        return null;
      case 'pause':
        this.paused = true;
        this.holder = null;
        return null;
      case 'resume':
        this.paused = false;
        return null;
      case 'step':
        this.time_s += command.ticks / 1000;
        return null;
      case 'speed':
        this.speed = command.factor;
        return null;
      case 'record':
        if (this.recording) this.recorded = { file: this.recording, folder: '/home/ada/experiments' };
        this.recording = command.on ? 'haptolith-20260101-120000.h5' : null;
        return null;
      case 'colour':
        return null;
    }
  }

  private remember(name: string, back: () => void): void {
    this.undo_name = name;
    this.undo = () => {
      back();
      this.undo = null;
      this.undo_name = null;
    };
  }

  private change(change: SceneChange): string | null {
    const scene = structuredClone(this.scene);
    if (change.body !== undefined) {
      const gravity = BODIES[change.body];
      if (gravity === undefined) return `body = ${change.body} is not valid: must be ${Object.keys(BODIES).join(', ')}`;
      scene.body = change.body;
      scene.gravity_m_s2 = [0, 0, -gravity];
    }
    if (change.tool) Object.assign(scene.tool, change.tool);
    for (const [key, value] of Object.entries(change.sliders ?? {})) {
      const slider = scene.sliders.find((candidate) => candidate.key === key);
      if (!slider) return `${key} is no slider`;
      slider.value = value;
    }
    if (change.preset !== undefined) Object.assign(scene.soil, { preset: change.preset, name: null });
    if (change.soil !== undefined) Object.assign(scene.soil, { preset: null, name: change.soil, friction: 'contact' });
    if (change.friction !== undefined) scene.soil.friction = change.friction;
    const new_bed = change.preset !== undefined || change.soil !== undefined || change.friction !== undefined;
    if (!new_bed) {
      this.scene = scene;
      return this.sendScene();
    }
    const before = this.scene;
    const bed = this.bed;
    this.remember('soil', () => this.exchange(before, bed));
    this.busy = 'preparing the bed: settled for 0.3 s';
    this.sendAll(this.status());
    setTimeout(() => {
      this.busy = null;
      this.exchange(scene, this.makeBed());
    }, 300);
    return null;
  }

  private exchange(scene: Scene, bed: MockBed): null {
    this.bed = bed;
    this.scene = { ...scene, scene: this.scene.scene + 1, particles: bed.count };
    for (const client of this.clients) client.needs_whole = true;
    return this.sendScene();
  }

  private sendScene(): null {
    this.sendAll(this.scene);
    return null;
  }

  private sendAll(message: object): void {
    const text = this.textOf(message);
    for (const { socket } of this.clients) socket.send(text);
  }

  /** A mesh and stones are sent unchanged. */
  private textOf(message: object): string {
    const { mesh, options } = this;
    const { stones } = options;
    return JSON.stringify(message, (key, value: unknown) => {
      if (key === 'stones') return stones?.map(({ text }) => text);
      return key === 'mesh' && value ? mesh : value;
    });
  }

  private sendStudy(): void {
    const force_n = Math.hypot(...this.bed.force_on_hand_n);
    for (const [number, message] of this.options.study?.messages(force_n) ?? [])
      this.clients.find((client) => client.number === number)?.socket.send(JSON.stringify(message));
  }

  private tick(): void {
    if (!this.paused) this.advance((FRAME_MS / 1000) * this.speed);
    this.sendFrames();
  }

  private advance(dt_s: number): void {
    this.time_s += dt_s;
    if (this.holder === null && this.scene.hand.motion !== 'still') this.playMotion();
    else if (this.holder === null) this.wished = this.tool;
    // The tool follows its target and yields to the force.
    const yields_m = 0.0012;
    this.tool = {
      position_m: this.tool.position_m.map((value, axis) => {
        const wished = this.wished.position_m[axis]! + yields_m * this.bed.force_on_hand_n[axis]!;
        return value + 0.35 * (wished - value);
      }) as Vec3,
      rotation: this.wished.rotation,
    };
    this.bed.step(dt_s, this.scene.tool, this.tool);
    if (Math.random() < 0.002) ++this.misses;
  }

  private playMotion(): void {
    const angle = 1.2 * this.time_s;
    const pitch = 0.3 * Math.sin(angle);
    this.wished = {
      position_m: [0.03 * Math.cos(angle), 0.02 * Math.sin(0.7 * angle), 0.035 + 0.025 * Math.sin(angle)],
      rotation: [Math.cos(pitch), 0, Math.sin(pitch), 0],
    };
  }

  private record(i: number): RecordValues {
    const { low_m, high_m } = this.scene.quantised;
    const part = (axis: number): number =>
      Math.round((65535 * (this.bed.position_m[3 * i + axis]! - low_m[axis]!)) / (high_m[axis]! - low_m[axis]!));
    const decades = (value: number, low: number, span: number): number =>
      value < low ? 1 : Math.min(255, Math.round(1 + (254 * Math.log10(value / low)) / span));
    return {
      x: part(0),
      y: part(1),
      z: part(2),
      speed: this.bed.still_ticks[i]! >= 200 ? 0 : decades(this.bed.speed_m_s[i]!, 1e-4, 4),
      force: this.bed.force_n[i]! < 1e-5 ? 0 : decades(this.bed.force_n[i]!, 1e-5, 6),
    };
  }

  private toolAt(pose: Pose, held_by: number): ToolState {
    const [force_n, torque_nm] = [this.bed.force_on_hand_n, this.bed.torque_on_hand_nm];
    return { turned: pose, hub: pose, force_n, torque_nm, wished: pose, opening_m: 0, held_by };
  }

  private sendFrames(): void {
    ++this.frame_number;
    if (this.clients.length === 0) return;
    const all = Array.from({ length: this.bed.count }, (_, i) => this.record(i));
    const late = Math.random() < 0.01;
    const buffer = encodeFrame(
      {
        scene: this.scene.scene,
        time_s: this.time_s,
        paused: this.paused,
        held: this.holder !== null,
        whole: true,
        forcesValid: true,
        tool: this.tool,
        force_n: this.bed.force_on_hand_n,
        torque_nm: this.bed.torque_on_hand_nm,
        wished: this.wished,
        longestTick_us: late ? 400 : 7 + 6 * Math.random(),
        misses: this.misses,
        awake: this.bed.awake,
        particles: this.bed.count,
        number: this.frame_number,
        opening_m: shapeOf(this.scene.tool).jaws ? this.scene.tool.opening_mm / 1000 : 0,
      },
      [[0, this.bed.count]],
      all,
      this.options.stones?.map(({ pose }) => pose),
      this.options.two_tools
        ? [this.toolAt(this.tool, this.holder ?? 0), this.toolAt(this.right.pose, this.right.holder)]
        : [],
    );
    for (const { socket } of this.clients) if (socket.bufferedAmount < 1_000_000) socket.send(buffer);
  }
}
