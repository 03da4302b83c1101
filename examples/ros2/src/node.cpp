// SPDX-License-Identifier: BSD-3-Clause
// Takes the joint velocities that a planner wants, publishes by what to scale them.
#include <memory>

#include <rclcpp/rclcpp.hpp>
#include <sensor_msgs/msg/joint_state.hpp>
#include <std_msgs/msg/float64.hpp>

#include "speed_guard/speed_guard.hpp"

namespace {

class Node : public rclcpp::Node {
public:
    Node() : rclcpp::Node("speed_guard"), guard(declare_parameter("joint_stiffness", 3000.0))
    {
        factors = create_publisher<std_msgs::msg::Float64>("~/factor", rclcpp::QoS(1));
        states = create_subscription<sensor_msgs::msg::JointState>(
            "~/planned_states", rclcpp::QoS(1), [this](const sensor_msgs::msg::JointState &state) {
                std_msgs::msg::Float64 message;
                message.data = guard.factor(state.name, state.position, state.velocity);
                factors->publish(message);
            });
    }

private:
    speed_guard::Guard guard;
    rclcpp::Publisher<std_msgs::msg::Float64>::SharedPtr factors;
    rclcpp::Subscription<sensor_msgs::msg::JointState>::SharedPtr states;
};

} // namespace

int main(int count, char **arguments)
{
    rclcpp::init(count, arguments);
    rclcpp::spin(std::make_shared<Node>());
    rclcpp::shutdown();
    return 0;
}
