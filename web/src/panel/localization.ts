/** How well the server knows the poses of a robot, in words and as a colour. */
import type { Localization } from '../api/types';

/** Colours of the style sheet. */
export type Quality = 'good' | 'fair' | 'bad';

/** Limits of good poses: metres, and the share of points that fit the map. */
const kGoodSigma = 0.05;
const kGoodInliers = 0.7;

const kCentimetre = 0.01;

export function qualityOf({ state, sigma, inliers, mountError }: Localization): Quality {
  if (state === 'lost' || mountError !== 0) return 'bad';
  return state === 'tracking' && sigma <= kGoodSigma && inliers >= kGoodInliers ? 'good' : 'fair';
}

/** Whether the robot waits for its place: an operator who knows it can say where it is. */
export function needsPlace({ state }: Localization): boolean {
  return state !== 'tracking';
}

/** "tracking, \u00b11 cm", "tracking, \u00b112 cm, 55 % of the scan fits the map", "...; the yaw of its laser\u2019s mount seems 90\u00b0 too large". */
export function wordsOf(localization: Localization): string {
  const degrees = Math.round((Math.abs(localization.mountError) * 180) / Math.PI);
  return (
    stateInWords(localization) +
    (degrees === 0
      ? ''
      : `; the yaw of its laser\u2019s mount seems ${degrees}\u00b0 too ${localization.mountError < 0 ? 'small' : 'large'}`)
  );
}

function stateInWords({ state, sigma, inliers }: Localization): string {
  switch (state) {
    case 'tracking':
      if (inliers === 0 && sigma === 0) return 'tracking, from its first scan on';
      return `tracking, \u00b1${around(sigma)}${inliers < kGoodInliers ? `, ${Math.round(100 * inliers)} % of the scan fits the map` : ''}`;
    case 'lost':
      return 'lost: its scans fit no place';
    case 'unlocated':
      return 'unlocated: its place in the map is not known yet';
  }
}

/** Never less than one centimetre. */
function around(metres: number): string {
  const centimetres = Math.max(1, Math.round(metres / kCentimetre));
  return centimetres < 100 ? `${centimetres} cm` : `${metres.toFixed(1)} m`;
}
