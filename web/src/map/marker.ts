/** A robot's symbol on the map: an arrowhead in the robot's heading. */

export interface MarkerLook {
  /** Radians, counter-clockwise from the map's x. */
  yaw: number;
  colour: string;
  halo: string;
  /** Hollow when the robot is offline. */
  filled: boolean;
}

const kLengthPx = 12;

/** @param at the robot's place in device pixels */
export function drawMarker(
  context: CanvasRenderingContext2D,
  at: number[],
  look: MarkerLook,
  pixelRatio: number,
): void {
  const [x = 0, y = 0] = at;
  const size = kLengthPx * pixelRatio;
  context.save();
  context.translate(x, y);
  context.rotate(-look.yaw);
  context.beginPath();
  context.moveTo(size, 0);
  context.lineTo(-0.75 * size, 0.75 * size);
  context.lineTo(-0.4 * size, 0);
  context.lineTo(-0.75 * size, -0.75 * size);
  context.closePath();
  context.lineJoin = 'round';
  context.strokeStyle = look.halo;
  context.lineWidth = 5 * pixelRatio;
  context.stroke();
  context.fillStyle = look.filled ? look.colour : look.halo;
  context.fill();
  context.strokeStyle = look.colour;
  context.lineWidth = 2 * pixelRatio;
  context.stroke();
  context.restore();
}

/** The area of the robot's body. @param radius device pixels */
export function drawFootprint(
  context: CanvasRenderingContext2D,
  [x = 0, y = 0]: number[],
  radius: number,
  { colour, halo }: MarkerLook,
  pixelRatio: number,
): void {
  context.save();
  context.beginPath();
  context.arc(x, y, radius, 0, 2 * Math.PI);
  context.globalAlpha = 0.2;
  context.fillStyle = colour;
  context.fill();
  context.globalAlpha = 1;
  context.strokeStyle = halo;
  context.lineWidth = 3 * pixelRatio;
  context.stroke();
  context.strokeStyle = colour;
  context.lineWidth = 1.5 * pixelRatio;
  context.stroke();
  context.restore();
}
