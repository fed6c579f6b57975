/** The parts of the page that tools use. */
import type OlMap from 'ol/Map';
import type { Robot, Session } from '../api/types';
import type { Picture } from '../picture';
import type { Theme } from '../theme';

export interface ToolContext {
  map: OlMap;
  /** The map's element. */
  target: HTMLElement;
  theme: () => Theme;
  /** The open session. */
  session: () => Session | null;
  robots: () => Robot[];
  picture: Picture;
}

/** The weave whose maps are shown instead of the session's own, for example for an earlier time; null: none. */
export function shownWeave({ picture }: ToolContext): string | null {
  return picture.main?.source.weave ?? null;
}
