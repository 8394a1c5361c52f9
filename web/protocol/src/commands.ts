// Commands of a client.

import type { Tool } from './messages.js';
import type { StudyCommand } from './study.js';

export const COLOUR_MODES = ['plain', 'force', 'speed', 'depth', 'sleep'] as const;
export type ColourMode = (typeof COLOUR_MODES)[number];

/** Interpretation of an uploaded file as a tool. */
export interface ToolFile {
  upload: number;
  name: string;
  unit_mm: number;
  sheet_thickness_mm: number;
}

/** Tool of a command. */
export interface OfTool {
  /** name of the tool; absent: the first */
  tool?: string;
}

export type Command =
  | ({ do: 'hold'; pose: [number, number, number, number, number, number, number] } & OfTool)
  | ({ do: 'release' } & OfTool)
  | { do: 'pause' | 'resume' }
  | ({ do: 'play'; motion: string } & OfTool)
  | FeltChange
  | { do: 'step'; ticks: number }
  | { do: 'speed'; factor: number }
  | { do: 'record'; on: boolean }
  | { do: 'colour'; by: ColourMode }
  | StudyCommand;

/** Changes that a person at a device feels. */
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

/** Encodes a command; with `id`, the program replies to it. */
export function encodeCommand(command: Command, id?: number): string {
  return JSON.stringify(id === undefined ? command : { id, ...command });
}
