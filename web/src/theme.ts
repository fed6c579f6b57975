/** The style sheet's colours, for drawing on canvases. */
import type { Palette, Rgb } from './layers/palette';

export const kRobotColours = 6;

export interface Theme {
  cells: Palette;
  robots: string[];
  halo: string;
  ink: string;
  accent: string;
  frontier: string;
  landmark: string;
  /** Colour of loops in the pose graph. */
  loop: string;
  warn: string;
  axisX: string;
  axisY: string;
  /** Colour of planned paths. */
  path: string;
}

export function readTheme(): Theme {
  const style = getComputedStyle(document.documentElement);
  const colour = (name: string): string => style.getPropertyValue(name).trim();
  const rgb = (name: string): Rgb => parseHex(colour(name));
  return {
    cells: {
      free: rgb('--cell-free'),
      occupied: rgb('--cell-occupied'),
      counters: [rgb('--counter-0'), rgb('--counter-5'), rgb('--counter-10'), rgb('--counter-15')],
      classes: {
        free: rgb('--class-free'),
        occupied: rgb('--class-occupied'),
        frontier: rgb('--class-frontier'),
        danger: rgb('--class-danger'),
      },
    },
    robots: Array.from({ length: kRobotColours }, (_, index) => colour(`--robot-${index}`)),
    halo: colour('--map-background'),
    ink: colour('--ink'),
    accent: colour('--accent'),
    frontier: colour('--class-frontier'),
    landmark: colour('--landmark'),
    loop: colour('--loop'),
    warn: colour('--warn'),
    axisX: colour('--axis-x'),
    axisY: colour('--axis-y'),
    path: colour('--path'),
  };
}

/** @param hex #rrggbb */
export function parseHex(hex: string): Rgb {
  const value = Number.parseInt(hex.slice(1), 16);
  return [(value >> 16) & 255, (value >> 8) & 255, value & 255];
}
