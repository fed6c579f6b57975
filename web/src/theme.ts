/** The colours of the style sheet, for what is drawn on canvases. */
import type { Palette, Rgb } from './map/palette';

export const kRobotColours = 6;

export interface Theme {
  cells: Palette;
  robots: string[];
  halo: string;
  ink: string;
}

export function readTheme(): Theme {
  const style = getComputedStyle(document.documentElement);
  const colour = (name: string): string => style.getPropertyValue(name).trim();
  return {
    cells: { free: parseHex(colour('--cell-free')), occupied: parseHex(colour('--cell-occupied')) },
    robots: Array.from({ length: kRobotColours }, (_, index) => colour(`--robot-${index}`)),
    halo: colour('--map-background'),
    ink: colour('--ink'),
  };
}

/** Calls back whenever the person's preference turns from light to dark or back. */
export function onThemeChange(changed: (theme: Theme) => void): void {
  matchMedia('(prefers-color-scheme: dark)').addEventListener('change', () => changed(readTheme()));
}

/** @param hex #rrggbb */
export function parseHex(hex: string): Rgb {
  const value = Number.parseInt(hex.slice(1), 16);
  return [(value >> 16) & 255, (value >> 8) & 255, value & 255];
}
