/** Assigns each robot a permanent colour, in the order in which the robots appear. */
export class RobotColours {
  private readonly order = new Map<string, number>();

  constructor(private readonly count: number) {}

  indexOf(robot: string): number {
    let index = this.order.get(robot);
    if (index === undefined) {
      index = this.order.size % this.count;
      this.order.set(robot, index);
    }
    return index;
  }
}
