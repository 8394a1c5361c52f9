// What a client asks for.

import type { Tool } from './messages.js';
import type { StudyCommand } from './study.js';

export const COLOUR_MODES = ['plain', 'force', 'speed', 'depth', 'sleep'] as const;
export type ColourMode = (typeof COLOUR_MODES)[number];

/** How a file that was uploaded is to be understood as a tool. */
export interface ToolFile {
  upload: number;
  name: string;
  unit_mm: number;
  sheet_thickness_mm: number;
}

export type Command =
  | { do: 'hold'; pose: [number, number, number, number, number, number, number] }
  | { do: 'release' | 'pause' | 'resume' }
  | { do: 'play'; manoeuvre: string }
  | FeltChange
  | { do: 'step'; ticks: number }
  | { do: 'speed'; factor: number }
  | { do: 'record'; on: boolean }
  | { do: 'colour'; by: ColourMode }
  | StudyCommand;

/** What a person at a device feels. */
export type FeltChange = (
  { do: 'reset' | 'level' | 'coarser' | 'undo' } | ({ do: 'scene' } & SceneChange) | ({ do: 'tool_file' } & ToolFile)
) & { confirmed?: true };

export function isFeltChange(command: Command): command is FeltChange {
  return ['reset', 'level', 'coarser', 'undo', 'scene', 'tool_file'].includes(command.do);
}

export interface SceneChange {
  preset?: string;
  soil?: string;
  friction?: string;
  body?: string;
  tool?: Partial<Tool>;
  sliders?: Record<string, number>;
}

/** Text of a command; with `id` the program replies to it. */
export function encodeCommand(command: Command, id?: number): string {
  return JSON.stringify(id === undefined ? command : { id, ...command });
}
