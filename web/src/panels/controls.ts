// The column at the side: world, tool, hand, bed, time, picture. It shows the state that the program reports, and sends
// requests of the user. A control changes permanently only with the program's next `scene` or `status`.

import {
  COLOUR_MODES,
  type ColourMode,
  type Command,
  type Hello,
  isSameTool,
  type Scene,
  type SceneChange,
  type Shape,
  type Slider,
  type Status,
  type Tool,
} from 'haptolith-protocol';
import { DRAWINGS, VIEW_NAMES, type Drawing, type ViewName } from '../settings';
import { canBecome, shapeOf, TOOL_SHAPES } from '../tool_shapes';
import { DRAG_WARNING, EXPLAIN, frictionModelName, sliderExplanation } from './explanations';
import { h, setText } from './html';
import { explain } from './tooltip';

const SLIDER_DELAY_MS = 150;
const SPEEDS = [1, 0.5, 0.2, 0.1, 0.05, 0.01];

export interface Actions {
  ask(command: Command): void;
  setColour(mode: ColourMode): void;
  setDrawing(drawing: Drawing): void;
  setView(name: ViewName): void;
  resetView(): void;
  setDigAnywhere(on: boolean): void;
  /** false: this browser cannot play sound */
  setSound(on: boolean): boolean;
  bringTool(): void;
  /** selects one of several tools by its number */
  chooseTool(tool: number): void;
  chooseToolFile(): void;
  /** null: recordings are not supported */
  recordingAddress: ((file: string) => string) | null;
}

export class Controls {
  readonly element: HTMLElement;
  private readonly soil = h('select', { id: 'soil' });
  private readonly friction = h('select', { id: 'friction' });
  private readonly drag_warning = h('p', { class: 'warning', role: 'note', hidden: true }, DRAG_WARNING);
  private readonly soil_facts = h('p', { class: 'facts numbers' });
  private readonly sliders = h('div', { class: 'sliders' });
  private readonly body = h('select', { id: 'body' });
  private readonly tools = h('div', { class: 'segmented tools', role: 'group', 'aria-label': 'Tool to hold' });
  private readonly tool_list = h('div', { class: 'field', hidden: true }, h('span', {}, 'Hold'), this.tools);
  private readonly shapes = h('div', { class: 'segmented', role: 'group', 'aria-label': 'Tool' });
  private readonly sizes = h('div', { class: 'sizes' });
  private readonly tool_file: HTMLElement;
  private readonly motion = h('select', { id: 'motion' });
  private readonly still: HTMLButtonElement;
  private readonly dig = h('input', { type: 'checkbox', id: 'dig' });
  private readonly sound = h('input', { type: 'checkbox', id: 'sound' });
  private readonly undo: HTMLButtonElement;
  private readonly pause: HTMLButtonElement;
  private readonly step: HTMLButtonElement;
  private readonly speed = h('select', { id: 'speed' });
  private readonly record: HTMLButtonElement;
  private readonly look_on = h('p', { class: 'look-on', role: 'note', hidden: true });
  private readonly record_file = h('p', { class: 'facts record-file', role: 'status' });
  private recorded = '';
  private readonly colours = h('div', { class: 'segmented', role: 'group', 'aria-label': 'Colour by' });
  private readonly drawings = h('div', { class: 'segmented', role: 'group', 'aria-label': 'Appearance of particles' });
  private readonly slider_inputs = new Map<string, { input: HTMLInputElement; value: HTMLElement; spec: Slider }>();
  private readonly slider_timers = new Map<string, number>();
  private readonly changing: HTMLFieldSetElement[];
  private sizes_of: Tool | null = null;
  private hello: Hello | null = null;
  private scene: Scene | null = null;
  private status: Status | null = null;
  private own = 0;

  /** `neutral`: a pause is not highlighted, for pictures, which are taken while time is paused. */
  constructor(
    private readonly act: Actions,
    private readonly neutral: boolean,
  ) {
    const button = (label: string, explanation: string, run: () => void): HTMLButtonElement => {
      const made = h('button', { type: 'button', onclick: run }, label);
      explain(made, explanation);
      return made;
    };

    this.soil.addEventListener('change', () => {
      const [kind, name] = this.soil.value.split(':') as [string, string];
      this.change(kind === 'preset' ? { preset: name } : { soil: name });
    });
    this.friction.addEventListener('change', () => this.change({ friction: this.friction.value }));
    this.body.addEventListener('change', () => this.change({ body: this.body.value }));
    this.motion.addEventListener('change', () => this.act.ask({ do: 'play', motion: this.motion.value }));
    this.speed.addEventListener('change', () => this.act.ask({ do: 'speed', factor: Number(this.speed.value) }));
    this.dig.addEventListener('change', () => this.act.setDigAnywhere(this.dig.checked));
    this.sound.addEventListener('change', () => {
      if (!this.act.setSound(this.sound.checked)) this.sound.checked = false;
    });
    this.speed.append(
      ...SPEEDS.map((factor) => h('option', { value: factor }, factor === 1 ? 'real time' : `${factor} ×`)),
    );

    this.still = button('Hold still', EXPLAIN.still, () => this.holdStill());
    const open_file = button('Open a mesh file…', EXPLAIN.tool_file, () => this.act.chooseToolFile());
    this.tool_file = h('div', { class: 'row buttons', hidden: true }, open_file);
    this.undo = button('Undo', EXPLAIN.undo, () => this.act.ask({ do: 'undo' }));
    this.pause = button('Pause', EXPLAIN.pause, () => this.togglePause());
    this.step = button('Step', EXPLAIN.step, () => this.stepOnce(1));
    this.record = button('Record', EXPLAIN.record, () => this.toggleRecord());
    this.record.hidden = act.recordingAddress === null;

    for (const mode of COLOUR_MODES) {
      const colour = button(mode, COLOUR_EXPLANATIONS[mode], () => this.act.setColour(mode));
      colour.dataset.colour = mode;
      colour.setAttribute('aria-pressed', 'false');
      this.colours.append(colour);
    }
    for (const drawing of DRAWINGS) {
      const made = button(drawing, EXPLAIN[drawing], () => this.act.setDrawing(drawing));
      made.dataset.drawing = drawing;
      made.setAttribute('aria-pressed', 'false');
      this.drawings.append(made);
    }
    const views = h(
      'div',
      { class: 'segmented', role: 'group', 'aria-label': 'View' },
      ...VIEW_NAMES.map((name) =>
        button(name === 'three-quarter' ? '¾' : name, EXPLAIN.view, () => this.act.setView(name)),
      ),
    );

    const dig = h('label', { class: 'check' }, this.dig, h('span', {}, 'drag anywhere to dig'));
    explain(this.dig, EXPLAIN.dig, dig);
    const sound = h('label', { class: 'check' }, this.sound, h('span', {}, 'sound'));
    explain(this.sound, EXPLAIN.sound, sound);
    explain(this.soil_facts, EXPLAIN.facts);
    this.soil_facts.tabIndex = 0;

    const speed = field('Speed', this.speed, EXPLAIN.speed);
    const changing = [
      group(
        'Soil and gravity',
        field('Soil', this.soil, EXPLAIN.soil),
        field('Friction model', this.friction, EXPLAIN.friction),
        this.drag_warning,
        this.soil_facts,
        this.sliders,
        field('Body', this.body, EXPLAIN.body),
      ),
      group('Tool', this.tool_list, this.shapes, this.sizes, this.tool_file),
      group(
        'Hand',
        field('Motion', this.motion, EXPLAIN.motion),
        h(
          'div',
          { class: 'row buttons' },
          this.still,
          button('Bring tool here', EXPLAIN.bring, () => this.act.bringTool()),
        ),
        dig,
      ),
      inlineGroup(
        'Bed',
        h(
          'div',
          { class: 'row buttons' },
          button('Reset', EXPLAIN.reset, () => this.act.ask({ do: 'reset' })),
          button('Level', EXPLAIN.level, () => this.act.ask({ do: 'level' })),
          this.undo,
        ),
      ),
      inlineGroup(
        'Time',
        h('div', { class: 'row buttons' }, this.pause, this.step, this.record),
        speed,
        this.record_file,
      ),
    ];
    this.changing = changing;
    this.element = h(
      'aside',
      { class: 'controls', 'aria-label': 'Controls' },
      this.look_on,
      ...changing,
      inlineGroup('View', this.drawings, this.colours, h('div', { class: 'row views' }, views, sound)),
    );
    this.setConnected(false);
  }

  setHello(hello: Hello): void {
    this.hello = hello;
    this.look_on.hidden = !hello.read_only;
    setText(this.look_on, hello.read_only ? 'View only: the program was started with --read-only.' : '');
    for (const fieldset of this.changing) fieldset.disabled = hello.read_only;
    this.soil.replaceChildren(
      h(
        'optgroup',
        { label: 'Presets of the ICRA 2021 paper, by friction coefficient' },
        ...hello.presets.map((preset) =>
          h('option', { value: `preset:${preset.name}` }, `${preset.name}, µ = ${preset.friction_coefficient}`),
        ),
      ),
      h(
        'optgroup',
        { label: 'Measured soils, by friction angle' },
        ...hello.soils.map((soil) =>
          h('option', { value: `soil:${soil.name}`, title: soil.source }, `${soil.name}, ${soil.friction_angle_deg}°`),
        ),
      ),
    );
    this.friction.replaceChildren(
      ...hello.frictions.map((name) => h('option', { value: name }, frictionModelName(name))),
    );
    this.body.replaceChildren(
      ...hello.bodies.map((body) => h('option', { value: body.name }, `${body.name}, ${body.gravity_m_s2} m/s²`)),
    );
    this.motion.replaceChildren(...hello.motions.map((name) => h('option', { value: name }, name)));
    this.shapes.replaceChildren(
      ...hello.shapes.map((shape) =>
        h(
          'button',
          {
            type: 'button',
            'data-shape': shape,
            'aria-pressed': 'false',
            onclick: () => this.change({ tool: { shape } }),
          },
          TOOL_SHAPES[shape].name,
        ),
      ),
    );
  }

  /** Shows a scene whose `tool` has this number in `tools`. */
  setScene(scene: Scene, own = 0): void {
    this.scene = scene;
    this.own = own;
    this.showTools(scene);
    const { soil, tool } = scene;
    select(this.soil, soil.preset ? `preset:${soil.preset}` : soil.name ? `soil:${soil.name}` : '', 'custom soil');
    const friction = soil.friction ?? '';
    select(this.friction, friction, frictionModelName(friction));
    this.drag_warning.hidden = friction !== 'icra2021';
    select(this.body, scene.body ?? '', `${Math.hypot(...scene.gravity_m_s2).toFixed(2)} m/s²`);
    select(this.motion, scene.hand.motion, scene.hand.motion);
    const angle = soil.friction_angle_deg === null ? '' : `${soil.friction_angle_deg.toFixed(1)}°, `;
    const cohesion = soil.cohesion_pa === null ? '' : `${Math.round(soil.cohesion_pa)} Pa, `;
    const density = soil.bulk_density_kg_m3 === null ? '' : `${Math.round(soil.bulk_density_kg_m3)} kg/m³`;
    setText(this.soil_facts, `${angle}${cohesion}${density}`);
    for (const button of this.shapes.children as HTMLCollectionOf<HTMLElement>) {
      const shape = button.dataset.shape as Shape;
      button.setAttribute('aria-pressed', String(shape === tool.shape));
      button.hidden = !canBecome(tool, shape);
      if (shape === 'mesh') button.title = tool.mesh?.name ?? '';
    }
    this.showSizes(scene);
    this.showSliders(scene.sliders, friction);
  }

  setStatus(status: Status): void {
    this.status = status;
    setText(this.pause, status.paused ? 'Resume' : 'Pause');
    this.pause.setAttribute('aria-pressed', String(status.paused && !this.neutral));
    this.step.disabled = !status.paused;
    this.undo.disabled = !status.can_undo;
    const undo = status.undo_redoes ? 'Redo' : 'Undo';
    setText(this.undo, status.undo ? `${undo} ${status.undo}` : undo);
    setText(this.record, status.recording ? 'Stop' : 'Record');
    this.record.setAttribute('aria-pressed', String(status.recording !== null));
    this.showRecording(status);
    select(this.speed, String(status.speed), `${status.speed} ×`);
  }

  setColour(mode: ColourMode): void {
    for (const button of this.colours.children as HTMLCollectionOf<HTMLElement>)
      button.setAttribute('aria-pressed', String(button.dataset.colour === mode));
  }

  setDrawing(drawing: Drawing): void {
    for (const button of this.drawings.children as HTMLCollectionOf<HTMLElement>)
      button.setAttribute('aria-pressed', String(button.dataset.drawing === drawing));
  }

  setConnected(connected: boolean): void {
    this.element.classList.toggle('offline', !connected);
    this.element.inert = !connected;
  }

  /** Shows the actual values again after a requested change was not made. */
  showAgain(): void {
    this.sizes_of = null;
    if (this.scene) this.setScene(this.scene, this.own);
  }

  togglePause(): void {
    this.act.ask({ do: this.status?.paused ? 'resume' : 'pause' });
  }

  stepOnce(ticks: number): void {
    this.act.ask({ do: 'step', ticks });
  }

  toggleRecord(): void {
    this.act.ask({ do: 'record', on: this.status?.recording == null });
  }

  toggleSlowMotion(): void {
    this.act.ask({ do: 'speed', factor: (this.status?.speed ?? 1) === 1 ? 0.1 : 1 });
  }

  toggleDig(): void {
    this.dig.checked = !this.dig.checked;
    this.act.setDigAnywhere(this.dig.checked);
  }

  holdStill(): void {
    this.act.ask({ do: 'play', motion: 'still' });
  }

  /** Selects the next entry of a list, for keys: soil, body, friction, shape, motion. */
  next(what: 'soil' | 'body' | 'friction' | 'shape' | 'motion', by: 1 | -1 = 1): void {
    if (!this.hello || !this.scene) return;
    if (what === 'shape') {
      if (this.own > 0) return; // only the first tool can change
      const { tool } = this.scene;
      const shapes = this.hello.shapes.filter((shape) => canBecome(tool, shape));
      const shape = following(shapes, tool.shape, by);
      return this.change({ tool: { shape } });
    }
    const list = this[what];
    const values = [...list.options].map((option) => option.value);
    list.value = following(values, list.value, by);
    list.dispatchEvent(new Event('change'));
  }

  /** Marks the tools that other clients hold; a client's number for each tool, 0 where it is free. */
  setHolders(held_by: number[], client: number | undefined): void {
    [...this.tools.children].forEach((button, i) => {
      const holder = held_by[i] ?? 0;
      const taken = holder !== 0 && holder !== client;
      button.classList.toggle('taken', taken);
      setText(button as HTMLElement, `${this.scene?.tools?.[i]?.name ?? ''}${taken ? ' (held)' : ''}`);
      (button as HTMLElement).title = taken ? `client ${holder} holds it` : '';
    });
  }

  /** Shows the names of several tools. Only the first can take another shape. */
  private showTools({ tools = [] }: Scene): void {
    const names = tools.length > 1 ? tools.map((tool) => tool.name) : [];
    if (JSON.stringify(names) !== this.tools.dataset.names) {
      this.tools.dataset.names = JSON.stringify(names);
      this.tools.replaceChildren(
        ...names.map((name, i) => h('button', { type: 'button', onclick: () => this.act.chooseTool(i) }, name)),
      );
    }
    this.tool_list.hidden = names.length === 0;
    [...this.tools.children].forEach((button, i) => button.setAttribute('aria-pressed', String(i === this.own)));
    this.shapes.hidden = this.sizes.hidden = this.own > 0;
    this.tool_file.hidden = this.own > 0 || this.hello?.takes_uploads !== true;
  }

  private change(change: SceneChange): void {
    this.act.ask({ do: 'scene', ...change });
  }

  private showRecording({ recording, recorded }: Status): void {
    const key = JSON.stringify([recording, recorded]);
    if (key === this.recorded) return;
    this.recorded = key;
    if (recording) this.record_file.replaceChildren(`recording ${recording}`);
    else if (recorded)
      this.record_file.replaceChildren(
        `${recorded.file} is in ${recorded.folder} on the computer that runs the program. `,
        h('a', { href: this.act.recordingAddress?.(recorded.file) ?? '', download: recorded.file }, 'Download'),
      );
    else this.record_file.replaceChildren();
  }

  private showSizes(scene: Scene): void {
    const { tool } = scene;
    const largest_mm = Math.round(1000 * Math.min(scene.box.width_m, scene.box.length_m));
    if (this.sizes_of && isSameTool(tool, this.sizes_of)) return;
    this.sizes_of = tool;
    // Rebuilding would take the focus away from the field that was just changed.
    const focused = document.activeElement instanceof HTMLInputElement ? document.activeElement.name : '';
    this.sizes.replaceChildren(
      ...shapeOf(tool).sizes.map((size) => {
        const { name } = size;
        const value = size.mm(tool);
        const input = h('input', {
          type: 'number',
          name: `size-${name}`,
          min: 1,
          max: largest_mm,
          step: 1,
          value,
          'aria-label': `${name} in mm`,
        });
        input.addEventListener('change', () => {
          const number = input.valueAsNumber;
          if (Number.isFinite(number) && number > 0) this.change({ tool: size.change(number, tool) });
          else input.value = String(value);
        });
        return h('label', { class: 'size' }, h('span', {}, name), input, h('span', { class: 'unit' }, 'mm'));
      }),
    );
    if (focused.startsWith('size-')) this.sizes.querySelector<HTMLInputElement>(`[name="${focused}"]`)?.focus();
  }

  private showSliders(sliders: Slider[], friction: string): void {
    const same =
      friction === this.sliders.dataset.friction &&
      sliders.length === this.slider_inputs.size &&
      sliders.every((slider) => this.slider_inputs.has(slider.key));
    if (!same) this.buildSliders(sliders, friction);
    for (const slider of sliders) {
      const shown = this.slider_inputs.get(slider.key)!;
      shown.spec = slider;
      Object.assign(shown.input, { min: String(slider.low), max: String(slider.high), step: String(slider.step) });
      // A slider that the user is dragging keeps its position.
      if (this.slider_timers.has(slider.key)) continue;
      shown.input.value = String(slider.value);
      setText(shown.value, sliderText(slider.value, slider));
    }
  }

  private buildSliders(sliders: Slider[], friction: string): void {
    this.sliders.dataset.friction = friction;
    this.slider_inputs.clear();
    this.sliders.replaceChildren(
      ...sliders.map((slider) => {
        const input = h('input', {
          type: 'range',
          min: slider.low,
          max: slider.high,
          step: slider.step,
          value: slider.value,
          'data-key': slider.key,
          'aria-label': slider.label,
        });
        const value = h('output', { class: 'numbers' }, sliderText(slider.value, slider));
        const entry = { input, value, spec: slider };
        input.addEventListener('input', () => this.slid(entry));
        this.slider_inputs.set(slider.key, entry);
        const label = h('label', { class: 'slider' }, h('span', {}, slider.label), value, input);
        const explanation = sliderExplanation(slider.key, friction);
        if (explanation) explain(input, explanation, label);
        return label;
      }),
    );
  }

  private slid(entry: { input: HTMLInputElement; value: HTMLElement; spec: Slider }): void {
    const { key } = entry.spec;
    setText(entry.value, sliderText(entry.input.valueAsNumber, entry.spec));
    clearTimeout(this.slider_timers.get(key));
    this.slider_timers.set(
      key,
      window.setTimeout(() => {
        this.slider_timers.delete(key);
        this.change({ sliders: { [key]: entry.input.valueAsNumber } });
      }, SLIDER_DELAY_MS),
    );
  }
}

function sliderText(value: number, slider: Slider): string {
  const digits = Math.max(0, Math.min(6, Math.ceil(-Math.log10(slider.step) - 1e-9)));
  const text = digits > 4 ? value.toExponential(1).replace('-', '\u2212') : value.toFixed(digits);
  return slider.unit ? `${text} ${slider.unit}` : text;
}

function following<T extends string>(values: T[], now: T, by: number): T {
  const at = values.indexOf(now);
  return values[(at + by + values.length) % values.length] ?? now;
}

function group(title: string, ...children: HTMLElement[]): HTMLFieldSetElement {
  return h('fieldset', { class: 'group' }, h('legend', {}, title), ...children);
}

/** A group with its title next to its first row. */
function inlineGroup(title: string, ...children: HTMLElement[]): HTMLFieldSetElement {
  const made = group(title, ...children);
  made.classList.add('inline');
  return made;
}

function field(label: string, control: HTMLElement, explanation: string): HTMLElement {
  const made = h('label', { class: 'field' }, h('span', {}, label), control);
  explain(control, explanation, made);
  return made;
}

const COLOUR_EXPLANATIONS: Record<ColourMode, string> = {
  plain: EXPLAIN.plain,
  force: EXPLAIN.force_colour,
  speed: EXPLAIN.speed_colour,
  depth: EXPLAIN.depth_colour,
  sleep: EXPLAIN.sleep,
};

/** Chooses a value; a value that is not in the list is shown as an extra entry that cannot be chosen. */
function select(list: HTMLSelectElement, value: string, foreign_label: string): void {
  list.querySelector('option[data-foreign]')?.remove();
  if (![...list.options].some((option) => option.value === value))
    list.prepend(h('option', { value, disabled: true, hidden: true, 'data-foreign': true }, foreign_label));
  if (list.value !== value) list.value = value;
}
