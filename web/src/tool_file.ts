// A tool from a file of the user: chosen or dropped on the page, uploaded, then requested.

import type { ToolFile } from 'haptolith-protocol';
import { h } from './panels/html';
import { askFirst } from './study/dialogs';

const ENDINGS = ['.stl', '.obj', '.glb', '.gltf'];
const MOST_BYTES = 32 * 1024 * 1024;
const UNITS_MM: [name: string, unit_mm: number][] = [
  ['millimetres', 1],
  ['centimetres', 10],
  ['metres', 1000],
  ['inches', 25.4],
];

/** Returns the reason why this file cannot be a tool, in words for a person; null: it may be one. */
export function whyNoTool(file: Pick<File, 'name' | 'size'>): string | null {
  if (!ENDINGS.some((ending) => file.name.toLowerCase().endsWith(ending)))
    return `${file.name} is not a mesh file: its name must end in ${ENDINGS.join(', ')}.`;
  if (file.size > MOST_BYTES)
    return `${file.name} has ${Math.ceil(file.size / 1024 / 1024)} MiB; the limit is 32. Use the key [tool] mesh of a scene file instead.`;
  return null;
}

interface Listener {
  /** uploads a file; returns the number with which a command refers to it; @throws Error in words for a person */
  upload(file: Blob): Promise<number>;
  /** whether the program currently accepts uploads */
  taken(): boolean;
  use(file: ToolFile): void;
  refused(why: string): void;
}

/** Requests files, by a button or dropped on the page. */
export class ToolFiles {
  /** hint while a file is dragged over the page */
  readonly overlay = h(
    'div',
    { class: 'drop-here', hidden: true },
    h('p', {}, 'Drop a mesh file here to use it as the tool', h('small', {}, 'STL, OBJ or glTF')),
  );
  private readonly chooser = h('input', { type: 'file', accept: ENDINGS.join(',') });

  constructor(private readonly listener: Listener) {
    this.chooser.addEventListener('change', () => {
      const file = this.chooser.files?.[0];
      this.chooser.value = ''; // so that the same file can be chosen again
      if (file) this.take(file);
    });
    let over = 0;
    const show = (depth: number): void => {
      over = depth;
      this.overlay.hidden = over === 0;
    };
    const holdsFiles = (event: DragEvent): boolean => event.dataTransfer?.types.includes('Files') === true;
    addEventListener('dragenter', (event) => {
      if (holdsFiles(event) && listener.taken()) show(over + 1);
    });
    addEventListener('dragleave', (event) => {
      if (holdsFiles(event)) show(Math.max(0, over - 1));
    });
    // Without these the browser leaves the page to show the file.
    addEventListener('dragover', (event) => {
      if (holdsFiles(event)) event.preventDefault();
    });
    addEventListener('drop', (event) => {
      if (!holdsFiles(event)) return;
      event.preventDefault();
      show(0);
      const file = event.dataTransfer?.files[0];
      if (file && listener.taken()) this.take(file);
    });
  }

  choose(): void {
    this.chooser.click();
  }

  private take(file: File): void {
    const why_not = whyNoTool(file);
    if (why_not !== null) return this.listener.refused(why_not);
    const metric = /\.gl(b|tf)$/i.test(file.name);
    const unit = h('select', { id: 'unit' }, ...UNITS_MM.map(([name, mm]) => h('option', { value: mm }, name)));
    const sheet = h('input', { type: 'number', id: 'sheet', min: 0, max: 20, step: 0.1, value: 0 });
    askFirst(
      {
        title: `Use ${file.name} as the tool?`,
        text: 'The hand holds it at its centre. Small holes are closed; other defects are reported.',
        choice: h(
          'div',
          { class: 'tool-file' },
          !metric && h('label', {}, h('span', {}, 'Unit of the file'), unit),
          h('label', {}, h('span', {}, 'Thickness of open surfaces in mm'), sheet),
        ),
        harmless: true,
        stay: 'Cancel',
        go_on: 'Use it',
      },
      () => {
        this.listener.upload(file).then(
          (number) =>
            this.listener.use({
              upload: number,
              name: file.name,
              unit_mm: metric ? 1000 : Number(unit.value),
              sheet_thickness_mm: Number(sheet.value) || 0,
            }),
          (error: unknown) => this.listener.refused(error instanceof Error ? error.message : String(error)),
        );
      },
    );
  }
}
